// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <variant>

#include "characters.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/poser.h"

/// In-betweens of drawn characters' published poses, posed by method hold, and of other ones that go further
/// (see test_characters.cpp on where they are found).
namespace planar::testing {
namespace {

/// How far the handles `far_apart` are moved, in diagonals.
using Offsets = std::array<std::array<double, 2>, 7>;

/// Vertices of the elephant.
const std::vector<int> far_apart{1504, 1159, 1601, 1819, 1629, 1760, 748};

/// A published pose by its number, -1 for the rest shape; or one of the elephant.
using KeyPose = std::variant<int, Offsets>;

struct Step {
  const char *name, *character;
  KeyPose from, to;
  double change_by_a_key = 0.02;  // of the diagonal
};

class Transition : public ::testing::TestWithParam<Step> {
 protected:
  void SetUp() override {
    const auto character = characters::read(PLANAR_TEST_DATA, GetParam().character);
    if (!character) GTEST_SKIP() << "no " << GetParam().character << " in " << PLANAR_TEST_DATA;
    shape = {character->vertices, character->triangles};
    diagonal = character->diagonal();
    keys = {posed(*character, GetParam().from), posed(*character, GetParam().to)};
  }

  Points posed(const characters::Character& character, const KeyPose& pose) const {
    if (const int* number = std::get_if<int>(&pose)) {
      if (*number < 0) return shape.vertices;
      const characters::Pose& published = character.poses.at(static_cast<std::size_t>(*number));
      return settled(published.handles, published.targets);
    }
    Points targets = shape.vertices(far_apart, Eigen::all);
    const Offsets& offsets = std::get<Offsets>(pose);
    for (Eigen::Index i = 0; i < targets.rows(); ++i) {
      const auto& [x, y] = offsets[static_cast<std::size_t>(i)];
      targets.row(i) += diagonal * Eigen::RowVector2d(x, y);
    }
    return settled(far_apart, targets);
  }

  Points settled(const std::vector<int>& handles, const Points& targets) const {
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(at(shape, handles));
    poser.move(targets);
    return poser.settle();
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
    EXPECT_LT(largest_difference(once, again), GetParam().change_by_a_key * diagonal) << more;
  }
}

const auto name_of = [](const auto& kind) { return kind.param.name; };

INSTANTIATE_TEST_SUITE_P(Published, Transition,
                         ::testing::Values(Step{"elephant0", "elephant", -1, 0},
                                           Step{"giraffe0", "giraffe", -1, 0},
                                           Step{"giraffe1", "giraffe", 0, 1}, Step{"horse0", "horse", -1, 0},
                                           Step{"horse1", "horse", 0, 1}, Step{"horse2", "horse", 1, 2},
                                           Step{"horse3", "horse", 2, 3}, Step{"horse4", "horse", 3, 4},
                                           Step{"racoon0", "racoon", -1, 0}, Step{"racoon1", "racoon", 0, 1},
                                           Step{"racoon2", "racoon", 1, 2}, Step{"racoon3", "racoon", 2, 3}),
                         name_of);

constexpr Offsets torn{
    {{0.31, -0.07}, {-0.2, 0.19}, {0.06, 0.22}, {-0.09, -0.37}, {-0.03, -0.11}, {0.19, 0.05}, {-0.41, -0.3}}};
constexpr Offsets low{{{-0.143, 0.033},
                       {-0.065, 0.086},
                       {-0.013, 0.067},
                       {0.122, 0.038},
                       {-0.088, -0.151},
                       {0.175, -0.011},
                       {-0.069, 0.014}}};
constexpr Offsets high{{{-0.019, 0.085},
                        {0.003, 0.001},
                        {-0.071, 0.047},
                        {-0.103, 0.067},
                        {0.152, -0.152},
                        {-0.247, 0.062},
                        {0.255, -0.1}}};

// In the first one triangles would flip soon after the rest shape; in the second one a triangle would nearly
// collapse half way. What is repaired as a whole need not be so on either side of one more key.
INSTANTIATE_TEST_SUITE_P(Far, Transition,
                         ::testing::Values(Step{"torn", "elephant", -1, torn, 0.03},
                                           Step{"squeezed", "elephant", low, high}),
                         name_of);

}  // namespace
}  // namespace planar::testing
