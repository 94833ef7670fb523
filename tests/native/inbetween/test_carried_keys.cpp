// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/index.h"
#include "cage/cage_support.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"

/// In-betweens of dense meshes through a cage.
namespace planar::testing {
namespace {

/// A dense bar at rest and bent, with what no cage has: a ripple finer than its triangles.
struct DenseBar {
  Shape shape = refined(bar(40, 0.15), 2);
  std::vector<Points> keys{shape.vertices,
                           rigid_motion(rolled(shape.vertices, 120.0 * degrees), 0.7, 2.0, 1.0)};

  void ripple() {
    for (Eigen::Index v = 0; v < keys[1].rows(); ++v) keys[1](v, 0) += v % 2 == 0 ? 0.0 : 0.001;
  }
};

TEST(CarriedKeys, KeysComeBackToTheBitAndFramesNearThemAreNear) {
  DenseBar dense;
  dense.ripple();
  const Inbetweens motion(dense.keys, dense.shape.triangles, {.cage = 200});
  EXPECT_EQ(motion.at(0.0), dense.keys[0]);
  EXPECT_EQ(motion.at(1.0), dense.keys[1]);
  EXPECT_LT(largest_difference(motion.at(1e-7), dense.keys[0]), 1e-5);
  EXPECT_LT(largest_difference(motion.at(1.0 - 1e-7), dense.keys[1]), 1e-5);
  EXPECT_TRUE(motion.report()[0].converged);
}

TEST(CarriedKeys, AreNearTheDenseSolution) {
  const DenseBar dense;
  for (const bool smooth : {false, true}) {
    const std::vector<Points> keys{dense.keys[0], dense.keys[1], dense.keys[0]};
    const Eigen::VectorXd times = uniform(9, 2.0);
    const auto solved = inbetween(keys, times, dense.shape.triangles, {.smooth = smooth});
    const auto carried = inbetween(keys, times, dense.shape.triangles, {.smooth = smooth, .cage = 400});
    EXPECT_LT(largest_difference(solved, carried), 0.005);
    for (const Points& frame : carried)
      EXPECT_EQ(distortion(dense.shape.vertices, frame, dense.shape.triangles).flipped, 0);
  }
}

TEST(CarriedKeys, AMeshNoLargerThanTheCageIsSolvedAsItIs) {
  const DenseBar dense;
  const auto n = static_cast<int>(dense.shape.vertices.rows());
  EXPECT_EQ(inbetween(dense.keys, uniform(5), dense.shape.triangles),
            inbetween(dense.keys, uniform(5), dense.shape.triangles, {.cage = n}));
}

TEST(CarriedKeys, AnchorsGoStraightAndJointsHold) {
  const DenseBar dense;
  const auto n = static_cast<int>(dense.shape.vertices.rows());
  const Shape both = joined(dense.shape, moved(dense.shape, 0.9, 0.4));
  std::vector<Points> keys{both.vertices, both.vertices};
  keys[1].topRows(n) = dense.keys[1];
  keys[1].bottomRows(n) = rigid_motion(both.vertices.bottomRows(n), -0.8, 1.0, 0.0);
  InbetweenOptions options;
  options.cage = 400;
  options.anchors = {(Eigen::VectorXi(2) << 1, 7).finished()};
  Edges joint(1, 2);
  joint << n - 1, n + 3;
  options.joints = {joint};
  const Points middle = Inbetweens(keys, both.triangles, options).at(0.3);
  const auto mean = [](const Points& x) { return Eigen::RowVector2d(0.5 * (x.row(1) + x.row(7))); };
  EXPECT_LT((mean(middle) - (0.7 * mean(keys[0]) + 0.3 * mean(keys[1]))).norm(), 2e-4);
  const auto offset = [&](const Points& x) { return Eigen::RowVector2d(x.row(n + 3) - x.row(n - 1)); };
  EXPECT_LT((offset(middle) - (0.7 * offset(keys[0]) + 0.3 * offset(keys[1]))).norm(), 2e-4);
}

TEST(CarriedKeys, TurnsAreThoseOfTheDensePartsAndLoneVerticesGoStraight) {
  // The second part has the cage's first vertices, or not: parts are told by their own.
  Shape shape = joined(grid(25), moved(grid(25, 2), 3.0, 0.0));
  shape.vertices.conservativeResize(shape.vertices.rows() + 1, 2);
  shape.vertices.bottomRows(1) << -1.0, -1.0;
  std::vector<Points> keys{shape.vertices, shape.vertices};
  keys[1].bottomRows(1) << 1.0, 2.0;
  InbetweenOptions options;
  options.cage = 200;
  options.turns = (Eigen::MatrixXi(1, 2) << 0, 1).finished();
  const Points quarter = Inbetweens(keys, shape.triangles, options).at(0.25);
  EXPECT_LT(largest_difference(quarter.topRows(625), keys[0].topRows(625)), 1e-5);
  const Points second = keys[0].middleRows(625, 625);
  const Eigen::RowVector2d centre = second.colwise().mean();
  const Points turned = rigid_motion(second.rowwise() - centre, 90.0 * degrees, centre.x(), centre.y());
  EXPECT_LT(largest_difference(quarter.middleRows(625, 625), turned), 1e-5);
  EXPECT_LT((quarter.row(1250) - Eigen::RowVector2d(-0.5, -0.25)).norm(), 1e-12);
}

TEST(CarriedKeys, AreCancelledAndRefused) {
  const DenseBar dense;
  InbetweenOptions options;
  options.cage = 200;
  options.progress = [](double share) { return share < 0.3; };
  EXPECT_THROW(Inbetweens(dense.keys, dense.shape.triangles, options), Cancelled);
  options.progress = {};
  const Inbetweens motion(dense.keys, dense.shape.triangles, options);
  EXPECT_THROW(motion.at(uniform(40), Outside::refuse, [](double share) { return share < 0.5; }), Cancelled);
  EXPECT_REFUSAL(motion.at(1.5), "outside");
  EXPECT_TRUE(motion.at(1.5, Outside::extrapolate).allFinite());

  Edges edges(1, 2);
  edges << 0, 1;
  EXPECT_REFUSAL(Inbetweens(dense.keys, edges, options), "cage: edges have none");
  options.anchors = {(Eigen::VectorXi(1) << 100000).finished()};
  EXPECT_REFUSAL(Inbetweens(dense.keys, dense.shape.triangles, options), "anchor, row 0: vertex 100000");
  options.anchors = {};
  options.method = InbetweenMethod::paper;
  EXPECT_REFUSAL(inbetween(dense.keys, uniform(5), dense.shape.triangles, options), "cage: the paper's");
  options.method = InbetweenMethod::midpoint;
  options.cage = 3;
  EXPECT_REFUSAL(Inbetweens(dense.keys, dense.shape.triangles, options), "cage: 3 vertices");
}

}  // namespace
}  // namespace planar::testing
