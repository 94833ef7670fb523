// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "planar/distortion.h"
#include "planar/poser.h"
#include "support.h"

namespace planar::testing {
namespace {

// settle() ends with a step of 1e-5 of the diagonal or less, which the last Newton step undercuts by far.
constexpr double settled = 1e-5;

double difference(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

double diagonal(const Points& x) { return (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm(); }

/// A grid, 3 long and 1 wide, posed by both ends and its middle.
class Hold : public ::testing::Test {
 protected:
  Hold() : shape(stretched()), handles(at(shape, {27, 31, 35})), rest(handles.positions(shape.vertices)) {
    poser.set_handles(handles);
  }
  static Shape stretched() {
    Shape shape = grid(9);
    shape.vertices.col(0) *= 3.0;
    return shape;
  }
  Points bent() const {
    Points targets = rest;
    targets.row(2) += Eigen::RowVector2d(-0.9, 1.4);
    return targets;
  }
  Points settled_at(const Points& targets) const {
    Poser fresh(shape.vertices, shape.triangles);
    fresh.set_handles(handles);
    fresh.move(targets);
    return fresh.settle();
  }
  Shape shape;
  Handles handles;
  Points rest;
  Poser poser{shape.vertices, shape.triangles};
};

TEST_F(Hold, HandlesAtTheirTargetsChangeNothing) {
  EXPECT_EQ(poser.move(rest), shape.vertices);
  EXPECT_TRUE(poser.report().converged);
  EXPECT_EQ(poser.report().iterations, 0);
}

TEST_F(Hold, OneHandleTranslatesAtAnyDistance) {
  poser.set_handles(at(shape, {40}));
  const Eigen::RowVector2d far(300.0, -100.0);
  const Points moved = rigid_motion(shape.vertices, 0.0, far.x(), far.y());
  EXPECT_LT(difference(poser.move(shape.vertices.row(40) + far), moved), 1e-9);
}

TEST_F(Hold, RigidTargetsGiveARigidMotionInOneMove) {
  for (const double angle : {0.3, 1.7, 3.1}) {
    poser.reset();
    const Points moved = poser.move(rigid_motion(rest, angle, 0.7, -3.0));
    EXPECT_LT(difference(moved, rigid_motion(shape.vertices, angle, 0.7, -3.0)), 1e-9) << angle;
    EXPECT_TRUE(poser.report().converged);
  }
}

TEST(HoldMinimum, PureStretchOfATriangle) {
  // Two corners are pulled apart along the x axis. By symmetry the triangle's Jacobian stays diag(a, b); b =
  // 1 is best, and a minimises area (a² + a⁻²) + 2 μ (stretch - a)² / 4, each pin being off by half of the
  // rest.
  const Shape shape{(Points(3, 2) << 0.0, 0.0, 1.0, 0.0, 0.5, 0.8).finished(),
                    (Triangles(1, 3) << 0, 1, 2).finished()};
  for (const double weight : {0.1, 1.0, 1000.0}) {
    for (const double stretch : {0.4, 3.0}) {
      double a = 1.0;
      for (int i = 0; i < 200; ++i) {
        const double slope = 0.4 * (2.0 * a - 2.0 / (a * a * a)) - weight * (stretch - a);
        a = std::max(0.5 * a, a - slope / (0.4 * (2.0 + 6.0 / (a * a * a * a)) + weight));
      }
      Poser poser(shape.vertices, shape.triangles, {.pin_weight = weight});
      poser.set_handles(at(shape, {0, 1}));
      poser.move((Points(2, 2) << 0.5 - 0.5 * stretch, 0.0, 0.5 + 0.5 * stretch, 0.0).finished());
      const Points expected = (Points(3, 2) << 0.5 - 0.5 * a, 0.0, 0.5 + 0.5 * a, 0.0, 0.5, 0.8).finished();
      EXPECT_LT(difference(poser.settle(), expected), settled) << weight << ' ' << stretch;
      EXPECT_TRUE(poser.report().converged);
    }
  }
}

TEST_F(Hold, ThePoseDependsOnTheHandlesNotOnTheirPath) {
  for (int i = 0; i <= 40; ++i) {
    Points targets = rest;
    const double a = 6.283185307179586 * i / 40.0;
    targets.row(2) += Eigen::RowVector2d(0.25 * std::cos(a) - 0.25, 0.8 * std::sin(a));
    poser.move(targets);
    ASSERT_EQ(poser.report().flipped, 0);
  }
  EXPECT_LT(difference(poser.settle(), shape.vertices), settled * diagonal(shape.vertices));
}

TEST_F(Hold, RefiningComesToWhereSettlingDoesInSmallSteps) {
  EXPECT_EQ(poser.refine(), shape.vertices) << "without targets";
  poser.move(bent());
  EXPECT_FALSE(poser.report().converged);
  for (int i = 0; i < 300 && !poser.report().converged; ++i) {
    const Points before = poser.positions();
    poser.refine();
    ASSERT_LE(difference(poser.positions(), before), 0.02 * diagonal(shape.vertices) * (1.0 + 1e-9));
  }
  EXPECT_TRUE(poser.report().converged);
  EXPECT_LT(difference(poser.positions(), settled_at(bent())), 2.0 * settled * diagonal(shape.vertices));
  const Points final = poser.positions();
  EXPECT_LT(difference(poser.refine(), final), settled * diagonal(shape.vertices));
  EXPECT_TRUE(poser.report().converged);
  EXPECT_NEAR(poser.report().furthest_handle, difference(handles.positions(poser.positions()), bent()),
              1e-12);
}

TEST_F(Hold, HandlesMayBeAddedMovedAndRemovedBetweenMoves) {
  poser.move(bent());
  const Handles others = inside(shape, {3, 60, 100, 127});
  poser.set_handles(others);
  EXPECT_NE(poser.positions(), shape.vertices) << "positions stay";
  poser.move(others.positions(shape.vertices));
  EXPECT_LT(difference(poser.settle(), shape.vertices), settled * diagonal(shape.vertices));
  poser.set_handles(handles);
  poser.move(bent());
  EXPECT_LT(difference(poser.settle(), settled_at(bent())), 2.0 * settled * diagonal(shape.vertices));
  poser.set_handles(at(shape, {}));
  const Points before = poser.positions();
  EXPECT_EQ(poser.move(Points(0, 2)), before) << "nothing is pinned";
  EXPECT_TRUE(poser.report().converged);
  // With a single handle left the shape springs back to a rigid copy of the rest.
  poser.set_handles(at(shape, {31}));
  poser.move(handles.positions(before).row(1));
  poser.settle();
  const Distortion d = distortion(shape.vertices, poser.positions(), shape.triangles);
  EXPECT_LT(d.area + d.angle, 4.0 + 1e-6);
}

TEST_F(Hold, WeightsPatchesAndCoincidingHandles) {
  const Handles twice = at(shape, {27, 35, 35});
  Points targets = twice.positions(shape.vertices);
  targets.row(1) += Eigen::RowVector2d(0.0, 0.5);
  targets.row(2) -= Eigen::RowVector2d(0.0, 0.5);
  poser.set_handles(twice);
  poser.move(targets);
  EXPECT_LT(difference(poser.settle(), shape.vertices), settled * diagonal(shape.vertices))
      << "handles at one point pull it to the middle of their targets";

  const auto reached = [&](const Eigen::VectorXd& weights) {
    const Handles ends = at(shape, {27, 35});
    Poser own(shape.vertices, shape.triangles, {.pin_weight = 1.0});
    own.set_handles(ends, weights);
    Points apart = ends.positions(shape.vertices);
    apart(0, 0) -= 1.0;
    apart(1, 0) += 1.0;
    own.move(apart);
    return Points(ends.positions(own.settle()) - apart);
  };
  const Points uneven = reached(Eigen::Vector2d(10.0, 0.1));
  EXPECT_LT(uneven.row(0).norm(), 0.05 * uneven.row(1).norm()) << "the pulls are equal, 10 u = 0.1 v";
}

TEST(HoldMesh, StiffTrianglesBendLess) {
  Shape shape = grid(9);
  shape.vertices.col(0) *= 3.0;
  Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(shape.triangles.rows());
  for (Eigen::Index t = 0; t < stiffness.size(); ++t) {
    if (shape.vertices(shape.triangles(t, 0), 0) > 1.5) stiffness[t] = 100.0;
  }
  const Handles handles = at(shape, {27, 31, 35});
  Points targets = handles.positions(shape.vertices);
  targets.row(2) += Eigen::RowVector2d(-0.5, 0.9);
  const auto bending = [&](const Eigen::VectorXd& factors) {
    Poser poser(shape.vertices, shape.triangles, {.stiffness = factors});
    poser.set_handles(handles);
    poser.move(targets);
    const Distortion d = distortion(shape.vertices, poser.settle(), shape.triangles);
    double sum = 0.0;
    for (Eigen::Index t = 0; t < stiffness.size(); ++t)
      sum += stiffness[t] > 1.0 ? d.triangle_angle[t] + d.triangle_area[t] - 4.0 : 0.0;
    return sum;
  };
  EXPECT_LT(bending(stiffness), 0.1 * bending({}));
}

TEST(HoldMesh, PartsIsolatedVerticesAndHinges) {
  Shape shape = joined(ring(16), moved(grid(5), 3.0, 0.0));
  shape = joined(shape, moved(grid(3), -3.0, 0.0));
  shape.vertices.conservativeResize(shape.vertices.rows() + 1, 2);
  shape.vertices.bottomRows(1) << 9, 9;
  const Handles handles = at(shape, {0, 8, 40, 66});  // two on the ring, one on the square, one isolated
  Poser poser(shape.vertices, shape.triangles);
  poser.set_handles(handles);
  Points targets = handles.positions(shape.vertices);
  targets.row(0) += Eigen::RowVector2d(0.2, 0.3);
  targets.row(2) += Eigen::RowVector2d(0.1, -0.4);
  targets.row(3) += Eigen::RowVector2d(1.0, 0.0);
  poser.move(targets);
  const Points posed = poser.settle();
  EXPECT_LT(difference(handles.positions(posed).topRows(2), targets.topRows(2)), 1e-2);
  EXPECT_LT(
      difference(posed.middleRows(32, 25), rigid_motion(shape.vertices.middleRows(32, 25), 0.0, 0.1, -0.4)),
      1e-9);
  EXPECT_EQ(posed.bottomRows(10), shape.vertices.bottomRows(10));
  EXPECT_NEAR(poser.report().furthest_handle, 1.0, 1e-12) << "the isolated vertex cannot follow";

  // Two triangles that meet in one vertex: a hinge, which turns freely.
  const Shape hinge{(Points(5, 2) << 0, 0, 1, 0, 0.5, 1, -1, 0, -0.5, 1).finished(),
                    (Triangles(2, 3) << 0, 1, 2, 0, 3, 4).finished()};
  Poser hinged(hinge.vertices, hinge.triangles);
  hinged.set_handles(at(hinge, {1, 2, 3}));
  Points turned = hinge.vertices.middleRows(1, 3);
  turned.row(2) = rigid_motion(turned.row(2), -0.6, 0.0, 0.0);
  hinged.move(turned);
  const Distortion d = distortion(hinge.vertices, hinged.settle(), hinge.triangles);
  EXPECT_LT(d.area + d.angle, 4.0 + 1e-6);
  EXPECT_LT(hinged.report().furthest_handle, 1e-4);
}

TEST(HoldMesh, AnyScaleAndPlace) {
  const Shape shape = grid(7);
  const Handles handles = at(shape, {0, 6, 45});
  Points targets = handles.positions(shape.vertices);
  targets.row(1) += Eigen::RowVector2d(0.3, 0.4);
  const auto pose = [&](double scale, double offset) {
    Poser poser((shape.vertices * scale).array() + offset, shape.triangles);
    poser.set_handles(handles);
    poser.move((targets * scale).array() + offset);
    const Points x = poser.settle();
    EXPECT_TRUE(poser.report().converged) << scale;
    EXPECT_EQ(poser.report().flipped, 0) << scale;
    return Points((x.array() - offset) / scale);
  };
  const Points expected = pose(1.0, 0.0);
  for (const double scale : {1e-6, 1e6}) EXPECT_LT(difference(pose(scale, 0.0), expected), settled) << scale;
  EXPECT_LT(difference(pose(1.0, 1e5), expected), settled);
}

TEST(HoldMesh, DegenerateRestTrianglesAreCarriedAlong) {
  Shape shape = grid(8);
  for (int i = 0; i < 16; ++i) shape.vertices(i, 1) = 0.0;  // a row of flat triangles
  shape.vertices.row(27) = shape.vertices.row(28);          // and some without an edge
  const Handles handles = at(shape, {0, 36, 63});
  Poser poser(shape.vertices, shape.triangles);
  poser.set_handles(handles);
  const Points start = handles.positions(shape.vertices);
  Points targets = start;
  for (int i = 0; i < 10; ++i) {
    targets.row(2) += Eigen::RowVector2d(-0.02, 0.03);
    poser.move(targets);
    ASSERT_EQ(poser.report().flipped, 0);
  }
  EXPECT_LT(poser.report().furthest_handle, 0.01);
  poser.move(start);
  poser.settle();
  EXPECT_LT(difference(poser.positions(), shape.vertices), 1e-3) << "springs hold what has no Jacobian";
}

TEST_F(Hold, RefusedCallsKeepTheState) {
  poser.move(bent());
  const Points before = poser.positions();
  Points targets = bent();
  targets(1, 1) = NAN;
  EXPECT_REFUSAL(poser.move(targets), "targets, row 1");
  EXPECT_REFUSAL(poser.move(Points::Zero(2, 2)), "targets has 2 rows, expected 3");
  EXPECT_REFUSAL(poser.reset(Points::Constant(81, 2, NAN)), "positions, row 0");
  EXPECT_REFUSAL(poser.set_handles(handles, Eigen::VectorXd::Zero(3)), "weights, row 0");
  Handles wrong = handles;
  wrong.vertices(1, 0) = 999;
  EXPECT_REFUSAL(poser.set_handles(wrong), "handles, row 1");
  EXPECT_EQ(poser.positions(), before);
  Poser other(shape.vertices, shape.triangles);
  other.set_handles(handles);
  other.move(bent());
  EXPECT_EQ(poser.settle(), other.settle()) << "handles and targets are those of before";
}

TEST_F(Hold, NumericalFailuresKeepTheState) {
  poser.move(bent());
  const Points before = poser.positions();
  const double distance = poser.report().furthest_handle;
  Points targets = Points::Constant(3, 2, 1e308);
  targets(0, 0) = -1e308;
  EXPECT_THROW(poser.move(targets), SolveError);
  EXPECT_EQ(poser.positions(), before);
  EXPECT_EQ(poser.report().furthest_handle, distance);
  EXPECT_LT(difference(poser.settle(), settled_at(bent())), 2.0 * settled * diagonal(shape.vertices));
}

TEST_F(Hold, ResetForgetsEverythingButTheHandles) {
  const Points first = poser.move(bent());
  const Points second = poser.move(bent());
  poser.reset();
  EXPECT_EQ(poser.positions(), shape.vertices);
  EXPECT_EQ(poser.settle(), shape.vertices) << "targets are forgotten";
  EXPECT_EQ(poser.move(bent()), first);
  EXPECT_EQ(poser.move(bent()), second);
}

TEST(HoldBits, AreTheSameInAnyThreadAndAtAnyPace) {
  const Shape large = grid(40);  // large enough for the worker
  const auto run = [&](int pause, Points& result) {
    Poser own(large.vertices, large.triangles);
    const Handles pins = at(large, {0, 820, 1599});
    own.set_handles(pins);
    Points targets = pins.positions(large.vertices);
    for (int i = 0; i < 6; ++i) {
      targets.row(1) += Eigen::RowVector2d(0.05, -0.04);
      own.move(targets);
      std::this_thread::sleep_for(std::chrono::milliseconds(pause));
    }
    own.refine();
    result = own.settle();
  };
  Points alone, first, second;
  run(20, alone);
  std::thread other([&] { run(0, first); });
  run(0, second);
  other.join();
  EXPECT_EQ(alone, first);
  EXPECT_EQ(alone, second);
}

}  // namespace
}  // namespace planar::testing
