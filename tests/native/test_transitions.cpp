// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "characters.h"
#include "inbetween_support.h"
#include "planar/distortion.h"
#include "planar/poser.h"

/// In-betweens of drawn characters' published poses, posed by method hold, and of other ones that go further
/// (see test_characters.cpp on where they are found).
namespace planar::testing {
namespace {

struct Step {
  const char* character;
  int number;  ///< of the pose it leads to; from the one before, or from the rest shape
};

class Transition : public ::testing::TestWithParam<Step> {
 protected:
  void SetUp() override {
    const auto character = characters::read(PLANAR_TEST_DATA, GetParam().character);
    if (!character) GTEST_SKIP() << "no " << GetParam().character << " in " << PLANAR_TEST_DATA;
    shape = {character->vertices, character->triangles};
    diagonal = character->diagonal();
    const auto posed = [&](int number) -> Points {
      if (number < 0) return shape.vertices;
      const characters::Pose& pose = character->poses.at(static_cast<std::size_t>(number));
      Poser poser(shape.vertices, shape.triangles);
      poser.set_handles(at(shape, pose.handles));
      poser.move(pose.targets);
      return poser.settle();
    };
    keys = {posed(GetParam().number - 1), posed(GetParam().number)};
  }

  /// Frames at uniform times, both keys among them.
  std::vector<Points> frames(int count) const {
    return frames_of(keys, Eigen::Vector2d(0.0, 1.0), uniform(count));
  }

  std::vector<Points> frames_of(const std::vector<Points>& of, const Eigen::VectorXd& key_times,
                                const Eigen::VectorXd& times) const {
    InbetweenOptions options;
    options.key_times = key_times;
    options.rest = shape.vertices;
    return inbetween(of, times, shape.triangles, options);
  }

  Shape shape;
  double diagonal = 0.0;
  std::vector<Points> keys;
};

TEST_P(Transition, IsNowhereMoreDistortedThanItsWorseEnd) {
  double area = 0.0, angle = 0.0;
  for (const Points& key : keys) {
    const Distortion d = distortion(shape.vertices, key, shape.triangles);
    area = std::max(area, d.area);
    angle = std::max(angle, d.angle);
  }
  for (const int count : {10, 26}) {
    for (const Points& frame : frames(count)) {
      const Distortion d = distortion(shape.vertices, frame, shape.triangles);
      EXPECT_LE(d.area, 1.001 * area);
      EXPECT_LE(d.angle, 1.001 * angle);
      EXPECT_EQ(d.flipped, 0);
    }
  }
}

TEST_P(Transition, HasNoJumpAndNoDetour) {
  const auto fine = frames(226);
  for (const int count : {10, 26}) {
    const auto some = frames(count);
    std::vector<double> jumps{0.0};
    Eigen::VectorXd way = Eigen::VectorXd::Zero(shape.vertices.rows()), fine_way = way;
    for (std::size_t i = 1; i < some.size(); ++i) {
      jumps.push_back(largest_difference(some[i], some[i - 1]));
      way += (some[i] - some[i - 1]).rowwise().norm();
    }
    jumps.push_back(0.0);
    for (std::size_t i = 1; i + 1 < jumps.size(); ++i) {
      EXPECT_LE(jumps[i], 1.5 * std::max(jumps[i - 1], jumps[i + 1])) << i << " of " << count;
    }
    for (std::size_t i = 1; i < fine.size(); ++i) fine_way += (fine[i] - fine[i - 1]).rowwise().norm();
    EXPECT_LE((way - 1.02 * fine_way).maxCoeff(), 1e-9 * diagonal);
  }
}

TEST_P(Transition, BackwardsIsItsReverse) {
  auto back = frames_of({keys[1], keys[0]}, Eigen::Vector2d(0.0, 1.0), uniform(10));
  std::reverse(back.begin(), back.end());
  EXPECT_LT(largest_difference(frames(10), back), 1e-6 * diagonal);
}

TEST_P(Transition, HardlyChangesByOneMoreKeyOfItsOwn) {
  const auto once = frames(10);
  for (const Eigen::Index more : {2, 5}) {
    const Eigen::VectorXd times = uniform(10);
    const auto again = frames_of({keys[0], once[static_cast<std::size_t>(more)], keys[1]},
                                 Eigen::Vector3d(0.0, times[more], 1.0), times);
    EXPECT_LT(largest_difference(once, again), 0.02 * diagonal) << more;
  }
}

INSTANTIATE_TEST_SUITE_P(Poses, Transition,
                         ::testing::Values(Step{"elephant", 0}, Step{"giraffe", 0}, Step{"giraffe", 1},
                                           Step{"horse", 0}, Step{"horse", 1}, Step{"horse", 2},
                                           Step{"horse", 3}, Step{"horse", 4}, Step{"racoon", 0},
                                           Step{"racoon", 1}, Step{"racoon", 2}, Step{"racoon", 3}),
                         [](const auto& kind) {
                           return kind.param.character + std::to_string(kind.param.number);
                         });

}  // namespace
}  // namespace planar::testing
