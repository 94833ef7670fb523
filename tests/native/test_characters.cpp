// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <filesystem>

#include "characters.h"
#include "planar/distortion.h"
#include "planar/poser.h"
#include "support.h"

/// Drawn characters and poses published with other methods. They are not part of the project: the tests look
/// for them in the folder named by PLANAR_TEST_DATA at configure time.
namespace planar::testing {
namespace {

struct Pose {
  const char* character;
  std::size_t number;
};

class Character : public ::testing::TestWithParam<Pose> {};

TEST_P(Character, ReachesItsPoseWithoutFlips) {
  const std::filesystem::path folder = PLANAR_TEST_DATA;
  const std::string name = GetParam().character;
  if (!std::filesystem::exists(folder / (name + ".json"))) GTEST_SKIP() << "no " << name << " in " << folder;
  const auto [vertices, triangles] = characters::read_obj(folder / (name + ".obj"));
  const Shape shape{vertices, triangles};
  const std::vector<Points> poses = characters::read_poses(folder / (name + ".json"));
  const Points& source = poses.at(2 * GetParam().number);
  const Handles handles = at(shape, characters::nearest_vertices(vertices, source));
  const Points start = handles.positions(shape.vertices);
  const Points targets = start + poses.at(2 * GetParam().number + 1) - source;
  const double diagonal = (shape.vertices.colwise().maxCoeff() - shape.vertices.colwise().minCoeff()).norm();

  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::akvf});
  poser.set_handles(handles);
  for (int step = 1; step <= 40; ++step) {
    poser.move(start + (targets - start) * (step / 40.0));
    ASSERT_EQ(poser.report().flipped, 0) << step;
  }
  // Measured: at most 0.006 of the diagonal after the moves.
  EXPECT_LT(poser.report().furthest_handle, 0.01 * diagonal);
  poser.settle();
  EXPECT_TRUE(poser.report().converged) << poser.report().furthest_handle / diagonal;
  EXPECT_EQ(poser.report().flipped, 0);
  // The method forgets the rest shape, and is above the best known for it (2.14 and 2.20 at most).
  // Measured: 2.25 and 2.32 at most.
  const Distortion d = distortion(shape.vertices, poser.positions(), shape.triangles);
  EXPECT_LT(d.area, 2.35);
  EXPECT_LT(d.angle, 2.4);
}

INSTANTIATE_TEST_SUITE_P(Poses, Character,
                         ::testing::Values(Pose{"elephant", 0}, Pose{"giraffe", 0}, Pose{"giraffe", 1},
                                           Pose{"horse", 0}, Pose{"horse", 1}, Pose{"horse", 2},
                                           Pose{"horse", 3}, Pose{"horse", 4}, Pose{"racoon", 0},
                                           Pose{"racoon", 1}, Pose{"racoon", 2}, Pose{"racoon", 3}),
                         [](const auto& kind) {
                           return kind.param.character + std::to_string(kind.param.number);
                         });

}  // namespace
}  // namespace planar::testing
