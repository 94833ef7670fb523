// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

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
  double distortion;  ///< area and angle, the best known: the prototype of method hold's
};

/// A character with the handles of a pose.
class Character : public ::testing::TestWithParam<Pose> {
 protected:
  void SetUp() override {
    const auto character = characters::read(PLANAR_TEST_DATA, GetParam().character);
    if (!character) GTEST_SKIP() << "no " << GetParam().character << " in " << PLANAR_TEST_DATA;
    const characters::Pose& pose = character->poses.at(GetParam().number);
    shape = {character->vertices, character->triangles};
    handles = at(shape, pose.handles);
    start = pose.start;
    targets = pose.targets;
    diagonal = character->diagonal();
  }
  Shape shape;
  Handles handles;
  Points start, targets;
  double diagonal = 0.0;
};

TEST_P(Character, ReachesItsPoseWithoutFlipsByKillingFields) {
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

TEST_P(Character, HoldsItsShapeInManyMovesAndInOne) {
  for (const int moves : {20, 1}) {
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(handles);
    for (int step = 1; step <= moves; ++step) {
      poser.move(start + (targets - start) * (static_cast<double>(step) / moves));
      ASSERT_EQ(poser.report().flipped, 0) << step;
    }
    poser.settle();
    EXPECT_TRUE(poser.report().converged);
    EXPECT_EQ(poser.report().flipped, 0);
    EXPECT_LT(poser.report().furthest_handle, 1e-3 * diagonal);
    const Distortion d = distortion(shape.vertices, poser.positions(), shape.triangles);
    EXPECT_LT(d.area + d.angle, 1.005 * GetParam().distortion) << moves;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Poses, Character,
    ::testing::Values(Pose{"elephant", 0, 4.059}, Pose{"giraffe", 0, 4.179}, Pose{"giraffe", 1, 4.096},
                      Pose{"horse", 0, 4.043}, Pose{"horse", 1, 4.056}, Pose{"horse", 2, 4.088},
                      Pose{"horse", 3, 4.308}, Pose{"horse", 4, 4.293}, Pose{"racoon", 0, 4.070},
                      Pose{"racoon", 1, 4.050}, Pose{"racoon", 2, 4.007}, Pose{"racoon", 3, 4.038}),
    [](const auto& kind) { return kind.param.character + std::to_string(kind.param.number); });

}  // namespace
}  // namespace planar::testing
