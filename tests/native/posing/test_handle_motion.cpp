// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "posing/handle_motion.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double rounding = 1e-12;

TEST(HandleMotion, SingleHandlesGoStraight) {
  const Points from = random_points(3, 1), to = random_points(3, 2);
  EXPECT_EQ(velocities_towards(from, to, {{{0}, true}, {{1, 2}, false}}), to - from);
}

TEST(HandleMotion, PatchesTurn) {
  // The velocities are those of a turn about the fixed point of the motion, whose spirals end at the targets.
  const Points from = random_points(5, 1);
  for (const double angle : {1e-6, 0.1, 1.0, -2.0, 3.1}) {
    const Points to = rigid_motion(from, angle, 0.3, -0.2);
    const Complex centre = Complex(0.3, -0.2) / (1.0 - std::polar(1.0, angle));
    const Points expected = rigid_field(from, angle, angle * centre.imag(), -angle * centre.real());
    // Near a translation the fixed point is far away.
    EXPECT_LT((velocities_towards(from, to, {{{0, 1, 2, 3, 4}, true}}) - expected).cwiseAbs().maxCoeff(),
              rounding * (1.0 + std::abs(centre)))
        << angle;
  }
}

TEST(HandleMotion, WhatIsNotRigidInAPatchIsADifference) {
  const Points from = random_points(4, 1);
  Points to = from;
  to.col(0) *= 1.2;
  to.rowwise() -= to.colwise().mean() - from.colwise().mean();
  const Points u = velocities_towards(from, to, {{{0, 1, 2, 3}, true}});
  EXPECT_LT((u - (to - from)).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_LT(u.colwise().sum().cwiseAbs().maxCoeff(), rounding);
}

TEST(HandleMotion, AllOfAPartTurnOnlyIfTheirTargetsAreRigid) {
  const Points from = random_points(4, 1);
  const std::vector<MovingTogether> sets{{{0, 1, 2, 3}, false}};
  Points to = rigid_motion(from, 2.0, 0.0, 0.0);
  EXPECT_GT((velocities_towards(from, to, sets) - (to - from)).cwiseAbs().maxCoeff(), 0.5);
  to.row(2) += Eigen::RowVector2d(0.5, 0.5);
  EXPECT_EQ(velocities_towards(from, to, sets), to - from);
}

TEST(HandleMotion, ATurnThatNothingDeterminesIsNone) {
  // Handles at one point, their targets apart, and the other way round.
  const Points some = random_points(4, 1), one = random_points(1, 2).replicate(4, 1);
  const std::vector<MovingTogether> sets{{{0, 1, 2, 3}, true}};
  EXPECT_LT((velocities_towards(one, some, sets) - (some - one)).cwiseAbs().maxCoeff(), rounding);
  EXPECT_LT((velocities_towards(some, one, sets) - (one - some)).cwiseAbs().maxCoeff(), rounding);
}

TEST(HandleMotion, ASetIsFittedWholeAndAppliesToWhatIsLeft) {
  // The rows 0 and 1 follow the first set; the others get the velocities of the second one, whichever of its
  // rows is named first.
  const Points from = random_points(4, 1);
  Points to = rigid_motion(from, 1.0, 0.3, -0.2);
  const Points turn = velocities_towards(from, to, {{{0, 1, 2, 3}, true}});
  for (const std::vector<int>& patch : {std::vector<int>{0, 1, 2, 3}, {3, 1, 2, 0}}) {
    const Points u = velocities_towards(from, to, {{{0, 1}, false}, {patch, true}});
    EXPECT_LT((u - turn).cwiseAbs().maxCoeff(), rounding);
  }
}

TEST(HandleMotion, HandlesAtTheirTargetsRest) {
  const Points from = random_points(3, 1);
  EXPECT_EQ(velocities_towards(from, from, {{{0, 1, 2}, true}}).cwiseAbs().maxCoeff(), 0.0);
}

}  // namespace
}  // namespace planar::testing
