// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <random>

#include "characters.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/poser.h"

/// No motion hangs on how numbers are rounded, which differs between compilers, libraries and processors.
namespace planar::testing {
namespace {

// A sanitizer takes several times as long.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr unsigned n_seeds = 50;
#else
constexpr unsigned n_seeds = 1000;
#endif

/// Each coordinate off by about so much.
std::vector<Points> perturbed(std::vector<Points> keys, double error, unsigned seed) {
  for (std::size_t k = 0; k < keys.size(); ++k) {
    keys[k] += error * random_points(keys[k].rows(), seed + 31U * static_cast<unsigned>(k));
  }
  return keys;
}

class Rounding : public ::testing::TestWithParam<AnchorPath> {};

TEST_P(Rounding, MovesSmoothFramesByAsMuchAsItMovesTheKeys) {
  Sequence s = bent();
  s.options.anchor_path = GetParam();
  s.options.turns = (Eigen::MatrixXi(3, 2) << 0, 1, 0, 1, -1, 2).finished();
  const std::vector<Points> keys = s.keys;
  const Eigen::VectorXd times = uniform(9, 4.0);
  const std::vector<Points> frames = s.solved().at(times);
  for (unsigned seed = 1; seed <= n_seeds; ++seed) {
    s.keys = perturbed(keys, 1e-12, seed);
    ASSERT_LT(largest_difference(s.solved().at(times), frames), 1e-9) << seed;
  }
}

TEST_P(Rounding, RefusesNoShapeOfTheParts) {
  for (unsigned seed = 1; seed <= n_seeds / 5; ++seed) {
    Sequence s = bent(seed);
    s.options.anchor_path = GetParam();
    for (const Points& frame : s.solved().at(uniform(9, 4.0))) {
      ASSERT_EQ(distortion(s.shape.vertices, frame, s.shape.triangles).flipped, 0) << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, Rounding, ::testing::Values(AnchorPath::straight, AnchorPath::arc));

class RoundingOfCharacters : public ::testing::TestWithParam<const char*> {};

/// Keys that a person would make, some frames of which are tracked, between three poses.
TEST_P(RoundingOfCharacters, MovesFramesByAsMuchAsItMovesTheKeys) {
  const auto character = characters::read(PLANAR_OWN_CHARACTERS, GetParam());
  ASSERT_TRUE(character);
  const Shape shape{character->vertices, character->triangles};
  std::vector<Points> keys{shape.vertices};
  for (std::size_t i = 0; i < 2; ++i) {
    const characters::Pose& pose = character->poses.at(i);
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(at(shape, pose.handles));
    for (int step = 1; step <= 10; ++step)
      poser.move(pose.start + (pose.targets - pose.start) * (step / 10.0));
    poser.settle();
    keys.push_back(poser.positions());
  }
  InbetweenOptions options;
  options.smooth = true;
  const Eigen::VectorXd times = uniform(5, 2.0);
  const std::vector<Points> frames = Inbetweens(keys, shape.triangles, options).at(times);
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Inbetweens motion(perturbed(keys, 1e-12 * character->diagonal(), seed), shape.triangles, options);
    EXPECT_LT(largest_difference(motion.at(times), frames), 1e-6 * character->diagonal()) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Own, RoundingOfCharacters, ::testing::Values("fox", "dragon"));

/// So far from the origin that numbers hardly tell the corners of a triangle apart.
TEST(RoundingOfFarShapes, RefusesNoKeys) {
  for (const double far : {1e9, 1e12, 1e13, 1e14, 1e15}) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
      Sequence s = bent(seed);
      for (Points& key : s.keys) key.rowwise() += Eigen::RowVector2d(far, -far);
      for (const Points& frame : s.solved().at(uniform(9, 4.0))) EXPECT_TRUE(frame.allFinite()) << far;
    }
  }
}

}  // namespace
}  // namespace planar::testing
