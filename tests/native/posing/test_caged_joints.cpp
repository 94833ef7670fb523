// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "cage/cage_support.h"
#include "inbetween/inbetween_support.h"
#include "planar/poser.h"

/// Parts that hang together by joints, posed through a cage.
namespace planar::testing {
namespace {

/// Dense bars of length 1, one behind the other, that overlap by `overlap`.
struct DenseChain {
  Shape link = refined(bar(10), 3);
  int n = static_cast<int>(link.vertices.rows());
  Shape shape;
  Handles first, second;  ///< of the joints

  /// \param pairs of points: 1 for hinges
  explicit DenseChain(int count, double overlap, int pairs) {
    shape = link;
    for (int i = 1; i < count; ++i) shape = joined(shape, moved(link, i * (1.0 - overlap), 0.0));
    std::vector<int> a, b;
    for (int i = 1; i < count; ++i) {
      for (int pair = 0; pair < pairs; ++pair) {
        const double y = pairs == 1 ? 0.0 : (pair - 0.5 * (pairs - 1)) * 0.08;
        const Eigen::RowVector2d place(i * (1.0 - overlap) + 0.5 * overlap, y);
        a.push_back(nearest(i - 1, place));
        b.push_back(nearest(i, shape.vertices.row(a.back())));
      }
    }
    first = at(shape, a);
    second = at(shape, b);
  }

  /// The vertex of a bar that is nearest to a place at rest.
  int nearest(int part, const Eigen::RowVector2d& place) const {
    int row = 0;
    (shape.vertices.middleRows(part * n, n).rowwise() - place).rowwise().squaredNorm().minCoeff(&row);
    return part * n + row;
  }

  Poser poser(const std::vector<int>& pins, bool caged = true) const {
    Poser result(shape.vertices, shape.triangles,
                 {.cage = caged ? std::optional<int>(500) : std::optional<int>()});
    result.set_joints(first, second);
    result.set_handles(at(shape, pins));
    return result;
  }

  double gap(const Points& x) const { return largest_difference(first.positions(x), second.positions(x)); }
};

TEST(CagedJoints, EndAtTheDenseSolution) {
  for (const int pairs : {1, 3}) {
    const DenseChain chain(2, 0.1, pairs);
    const std::vector<int> pins{chain.nearest(0, {0.0, 0.0}), chain.nearest(0, {0.5, 0.0}),
                                chain.nearest(1, {1.9, 0.0})};
    const Points start = chain.shape.vertices(pins, Eigen::all);
    std::vector<Points> shown, settled;
    for (const bool caged : {true, false}) {
      Poser poser = chain.poser(pins, caged);
      Points targets = start;
      for (int step = 1; step <= 10; ++step) {
        targets.row(2) = start.row(2) + step / 10.0 * Eigen::RowVector2d(-0.35, 0.7);
        poser.move(targets);
        EXPECT_EQ(poser.report().flipped, 0);
      }
      while (!poser.report().converged && !poser.report().coarse_settled) poser.refine();
      shown.push_back(poser.positions());
      EXPECT_LT(chain.gap(shown.back()), 1e-4 * 1.9);
      settled.push_back(poser.settle());
      EXPECT_TRUE(poser.report().converged);
      EXPECT_EQ(poser.report().flipped, 0);
      EXPECT_LT(chain.gap(settled.back()), 1e-4 * 1.9);
    }
    EXPECT_GT(largest_difference(settled[0], chain.shape.vertices), 0.5);
    EXPECT_LT(largest_difference(shown[0], shown[1]), 0.005 * 1.9) << pairs;
    EXPECT_LT(largest_difference(settled[0], settled[1]), 1e-4 * 1.9) << pairs;
  }
}

/// A pose that has settled is taken hold of, and a limb turned far: no joint opens on the way.
TEST(CagedJoints, StayTogetherWhenASettledDrawingIsMovedOn) {
  const DenseChain chain(3, 0.1, 1);
  const std::vector<int> pins{chain.nearest(0, {0.0, 0.0}), chain.nearest(0, {0.4, 0.1}),
                              chain.nearest(2, {2.7, 0.0})};
  Poser poser = chain.poser(pins);
  Points targets = chain.shape.vertices(pins, Eigen::all);
  targets.row(1) += Eigen::RowVector2d(-0.05, 0.15);
  targets.row(2) += Eigen::RowVector2d(-0.6, 0.9);
  poser.move(targets);
  const Points settled = poser.settle();
  Poser other = chain.poser(pins);
  other.reset(settled);
  EXPECT_LT(largest_difference(other.move(targets), settled), 1e-4 * 2.8);
  double widest = 0.0;
  for (int step = 1; step <= 40; ++step) {
    targets.row(2) += Eigen::RowVector2d(-0.04, 0.03 * std::cos(0.2 * step));
    widest = std::max(widest, chain.gap(other.move(targets)));
    EXPECT_EQ(other.report().flipped, 0);
  }
  EXPECT_LT(widest, 2e-3 * 2.8);
  EXPECT_LT(chain.gap(other.settle()), 1e-4 * 2.8);
}

TEST(CagedJoints, WhatHangsOnPinsFollowsAndAllElseStaysToTheBit) {
  const DenseChain chain(3, 0.1, 1);
  Poser poser(chain.shape.vertices, chain.shape.triangles, {.cage = 500});
  const std::vector<int> pins{chain.nearest(0, {0.1, 0.0}), chain.nearest(0, {0.8, 0.0})};
  poser.set_handles(at(chain.shape, pins));
  const Points start = chain.shape.vertices(pins, Eigen::all);
  poser.move(start);
  Handles first = chain.first, second = chain.second;
  first.vertices.conservativeResize(1, 3);  // the joint of the first two bars
  first.weights.conservativeResize(1, 3);
  second.vertices.conservativeResize(1, 3);
  second.weights.conservativeResize(1, 3);
  poser.set_joints(first, second);
  for (int step = 1; step <= 8; ++step) poser.move(rigid_motion(start, 0.1 * step, 0.05 * step, 0.0));
  const Points& posed = poser.settle();
  const Points expected = rigid_motion(chain.shape.vertices, 0.8, 0.4, 0.0);
  EXPECT_LT(largest_difference(posed.topRows(2 * chain.n), expected.topRows(2 * chain.n)), 1e-5);
  EXPECT_EQ(posed.bottomRows(chain.n), chain.shape.vertices.bottomRows(chain.n));
}

TEST(CagedJoints, RefuseWhatTheyCannotBeAndKeepThoseOfBefore) {
  const DenseChain chain(2, 0.1, 1);
  const Shape& shape = chain.shape;
  Poser poser = chain.poser({0, 9});
  EXPECT_REFUSAL(poser.set_joints(at(shape, {1}), at(shape, {4})), "second, row 0: on the same part");
  Handles outside = at(shape, {chain.n});
  outside.vertices(0, 0) = 100000;
  EXPECT_REFUSAL(poser.set_joints(at(shape, {1}), outside), "second, row 0: vertex 100000");
  for (const PoserMethod method : {PoserMethod::akvf, PoserMethod::arap}) {
    Poser other(shape.vertices, shape.triangles, {.method = method, .cage = 500});
    EXPECT_REFUSAL(other.set_joints(chain.first, chain.second), "only method hold");
  }
  const Points start = shape.vertices(std::vector<int>{0, 9}, Eigen::all);
  poser.move(start.rowwise() + Eigen::RowVector2d(0.5, 0.2));
  EXPECT_LT(chain.gap(poser.settle()), 1e-6);
}

}  // namespace
}  // namespace planar::testing
