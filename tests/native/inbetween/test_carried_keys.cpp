// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "base/index.h"
#include "cage/cage_support.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/poser.h"

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

/// A dense bar that stands on its ends while its middle, up in one key and down in the other, swings.
struct Swinging {
  Shape shape = refined(bar(30), 2);
  std::vector<Points> keys{pushed(0.06), pushed(-0.05)};

  Points pushed(double by) const {
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(at(shape, {1, 46, 91}));
    poser.move((Points(3, 2) << 0.0, 0.0, 0.5, by, 1.0, 0.0).finished());
    return poser.settle();
  }
};

Points between(const Points& from, const Points& to, double u) { return from + u * (to - from); }

TEST(CarriedKeys, PinsStandAsTheyDoInTheDenseSolution) {
  const Swinging swinging;
  const Shape& shape = swinging.shape;
  std::vector<Points> keys = swinging.keys;
  for (const bool rippled : {false, true}) {
    if (rippled) {  // beyond what a cage has, also at the pins
      for (Eigen::Index v = 0; v < keys[1].rows(); ++v) keys[1](v, 1) += v % 2 == 0 ? 0.0 : 0.001;
    }
    InbetweenOptions options;
    options.pins = inside(shape, {0, static_cast<int>(shape.triangles.rows()) - 1});
    const auto solved = inbetween(keys, uniform(9), shape.triangles, options);
    options.cage = 200;
    const auto carried = inbetween(keys, uniform(9), shape.triangles, options);
    const auto free = inbetween(keys, uniform(9), shape.triangles, {.cage = 200});
    double drift = 0.0;
    for (std::size_t i = 0; i < carried.size(); ++i) {
      const Points places = between(options.pins.positions(keys[0]), options.pins.positions(keys[1]),
                                    static_cast<double>(i) / 8.0);
      EXPECT_LT(largest_difference(options.pins.positions(carried[i]), places), 1e-6) << i;
      drift = std::max(drift, largest_difference(options.pins.positions(free[i]), places));
      EXPECT_EQ(distortion(shape.vertices, carried[i], shape.triangles).flipped, 0);
    }
    EXPECT_GT(drift, 1e-4);  // there was something to hold
    if (!rippled) {
      EXPECT_LT(largest_difference(solved, carried), 0.005);
    }
    EXPECT_EQ(carried.front(), keys[0]);
    EXPECT_EQ(carried.back(), keys[1]);
  }
}

TEST(CarriedKeys, PinsGoOnPathsAndAreHeldWhereThatIsSaid) {
  const Swinging swinging;
  const Shape& shape = swinging.shape;
  const std::vector<Points> keys{swinging.keys[0], swinging.keys[1], swinging.keys[0]};
  InbetweenOptions options;
  options.pins = at(shape, {0, 1, 2, 46});
  options.pin_groups = (Eigen::VectorXi(4) << 3, 3, 3, 8).finished();
  options.pinned = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(2, 4, true);
  options.pinned.row(1) << true, true, true, false;
  options.cage = 200;
  const Inbetweens motion(keys, shape.triangles, options);
  const Eigen::VectorXd times = (Eigen::VectorXd(2) << 0.5, 1.5).finished();
  std::vector<Points> paths(2, Points::Constant(4, 2, std::numeric_limits<double>::quiet_NaN()));
  for (Points& path : paths) path.row(3) << 0.5, 0.1;
  const std::vector<Points> frames = motion.at(times, Outside::refuse, {}, paths);
  EXPECT_LT((frames[0].row(46) - paths[0].row(3)).norm(), 1e-6);
  EXPECT_GT((frames[1].row(46) - paths[1].row(3)).norm(), 0.01);
  for (std::size_t i = 0; i < 2; ++i) {  // the patch goes straight in its middle and keeps its shape
    const auto middle = [](const Points& x) { return Eigen::RowVector2d(x.topRows(3).colwise().mean()); };
    EXPECT_LT((middle(frames[i]) - 0.5 * (middle(keys[0]) + middle(keys[1]))).norm(), 1e-6);
    EXPECT_NEAR((frames[i].row(0) - frames[i].row(2)).norm(), (keys[0].row(0) - keys[0].row(2)).norm(), 1e-4);
  }
  EXPECT_LT(largest_difference(motion.at(times, Outside::refuse, {}, paths), frames), 1e-15);
}

TEST(CarriedKeys, WhatIsCarriedComesAlongAndIsHeld) {
  const Swinging swinging;
  const auto n = static_cast<int>(swinging.shape.vertices.rows());
  const Shape both = joined(swinging.shape, moved(swinging.shape, 0.95, 0.0));
  std::vector<Points> keys{both.vertices, both.vertices};
  keys[1].topRows(n) = rigid_motion(rolled(both.vertices.topRows(n), 60.0 * degrees), 0.3, 0.0, 0.0);
  keys[1].bottomRows(n) = rigid_motion(swinging.keys[0], 0.8, 0.0, 0.0);
  const Eigen::RowVector2d way = keys[1].row(91) - keys[1].row(n + 1) - Eigen::RowVector2d(0.05, 0.0);
  keys[1].bottomRows(n).rowwise() += way;
  InbetweenOptions options;
  Edges joint(1, 2);
  joint << 91, n + 1;
  options.joints = {joint};
  options.pins = at(both, {1, 46, n + 91});
  options.anchors = {(Eigen::VectorXi(1) << 1).finished()};
  const auto solved = inbetween(keys, uniform(5), both.triangles, options);
  options.cage = 400;
  const auto carried = inbetween(keys, uniform(5), both.triangles, options);
  const auto offset = [&](const Points& x) { return Eigen::RowVector2d(x.row(n + 1) - x.row(91)); };
  for (std::size_t i = 0; i < carried.size(); ++i) {
    const double u = static_cast<double>(i) / 4.0;
    EXPECT_LT(
        largest_difference(options.pins.positions(carried[i]),
                           between(options.pins.positions(keys[0]), options.pins.positions(keys[1]), u)),
        1e-6);
    EXPECT_LT((offset(carried[i]) - (1.0 - u) * offset(keys[0]) - u * offset(keys[1])).norm(), 5e-4) << i;
  }
  EXPECT_LT(largest_difference(solved, carried), 0.02);  // a hundredth of the size
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
  options.pins = at(dense.shape, {0});
  options.pins.vertices(0, 0) = 100000;
  EXPECT_REFUSAL(Inbetweens(dense.keys, dense.shape.triangles, options), "vertex 100000");
  options.pins = {};
  options.method = InbetweenMethod::paper;
  EXPECT_REFUSAL(inbetween(dense.keys, uniform(5), dense.shape.triangles, options), "cage: the paper's");
  options.method = InbetweenMethod::midpoint;
  options.cage = 3;
  EXPECT_REFUSAL(Inbetweens(dense.keys, dense.shape.triangles, options), "cage: 3 vertices");
}

}  // namespace
}  // namespace planar::testing
