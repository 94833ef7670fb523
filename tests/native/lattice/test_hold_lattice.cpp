// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <map>

#include "dense.h"
#include "lattice/held_shape.h"
#include "lattice/lattice_frame.h"
#include "lattice/lattice_support.h"
#include "mesh/triangle_shape.h"

namespace planar::testing {
namespace {

Coordinates settled(LatticeSolver& solver, const Coordinates& targets,
                    const Coordinates& lattice_targets = no_targets) {
  solver.solve(targets, lattice_targets);
  solver.settle();
  return solver.positions();
}

double furthest(const Coordinates& a, const Coordinates& b) { return (a - b).rowwise().norm().maxCoeff(); }

/// Bases that reproduce affine motions, with the margin they need for it.
struct Exact {
  LatticeBasis basis;
  int margin;
};
class ExactBases : public ::testing::TestWithParam<Exact> {
 protected:
  InLattice in{grid(13), {8, 7}, GetParam().basis, GetParam().margin};
};

TEST_P(ExactBases, OnePinTranslates) {
  LatticeSolver solver = in.solver();
  solver.set_handles(in.handles({40}));
  const Eigen::RowVector2d way(3.0, -2.0);
  const Coordinates posed = settled(solver, in.rest({40}).rowwise() + way);
  EXPECT_LT(furthest(posed, in.shape.vertices.rowwise() + way), 1e-9);
  EXPECT_TRUE(solver.report().converged);
}

TEST_P(ExactBases, PinsTurnedTurnAll) {
  LatticeSolver solver = in.solver();
  const std::vector<int> pins{0, 12, 90, 168};
  solver.set_handles(in.handles(pins));
  for (const double degrees : {90.0, 180.0, -45.0}) {
    const double angle = degrees * 3.141592653589793 / 180.0;
    const Coordinates posed = settled(solver, rigid_motion(in.rest(pins), angle, 1.0, 2.0));
    EXPECT_LT(furthest(posed, rigid_motion(in.shape.vertices, angle, 1.0, 2.0)), 1e-9) << degrees;
  }
}

TEST_P(ExactBases, PointsTurnedTurnAll) {
  LatticeSolver solver = in.solver();
  const Points rest = in.lattice_rest;
  Eigen::VectorXi all(in.lattice_rest.rows());
  for (int i = 0; i < all.size(); ++i) all[i] = i;
  solver.set_handles({{}, {}, all, {}});
  const Coordinates posed = settled(solver, no_targets, rigid_motion(rest, 1.5, 0.0, 1.0));
  EXPECT_LT(furthest(posed, rigid_motion(in.shape.vertices, 1.5, 0.0, 1.0)), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, ExactBases,
                         ::testing::Values(Exact{LatticeBasis::linear, 0}, Exact{LatticeBasis::linear, 1},
                                           Exact{LatticeBasis::bspline, 1},
                                           Exact{LatticeBasis::catmull_rom, 1},
                                           Exact{LatticeBasis::bernstein, 0}));

/// The energy of planar/lattice.h and its derivatives by d, by dense algebra.
class DenseHold {
 public:
  DenseHold(const InLattice& in, const std::vector<int>& pins, const Points& targets)
      : w_(in.weights),
        shape_(in.shape.vertices, in.shape.triangles, flat_triangles(in.shape.vertices, in.shape.triangles)),
        rest_(in.shape.vertices),
        pins_(pins),
        targets_(targets) {
    const std::vector<Difference> differences =
        second_differences({in.lattice.count[0], in.lattice.count[1], 1});
    smooth_.setZero(static_cast<Eigen::Index>(differences.size()), w_.cols());
    for (std::size_t i = 0; i < differences.size(); ++i) {
      for (std::size_t k = 0; k < differences[i].point.size(); ++k) {
        smooth_(static_cast<Eigen::Index>(i), differences[i].point[k]) = differences[i].coefficient[k];
      }
    }
  }

  double value(const Points& d, Points& gradient) const {
    const Points u = w_ * d;
    Points g;
    double sum = shape_.gradient(u, g);
    for (std::size_t i = 0; i < pins_.size(); ++i) {
      const Eigen::RowVector2d off =
          rest_.row(pins_[i]) + u.row(pins_[i]) - targets_.row(static_cast<Eigen::Index>(i));
      sum += 1e3 * off.squaredNorm();
      g.row(pins_[i]) += 2e3 * off;
    }
    gradient = w_.transpose() * g + 2e-3 * smooth_.transpose() * (smooth_ * d);
    return sum + 1e-3 * (smooth_ * d).squaredNorm();
  }

  /// Newton's iteration with the Hessian of differences.
  void descend(Points& d) const {
    for (int i = 0; i < 6; ++i) {
      Points g;
      value(d, g);
      Eigen::MatrixXd hessian(d.size(), d.size());
      for (Eigen::Index k = 0; k < d.size(); ++k) {
        Points after = d, before = d, ga, gb;
        after.data()[k] += 1e-6;
        before.data()[k] -= 1e-6;
        value(after, ga);
        value(before, gb);
        hessian.col(k) = flat(ga - gb) / 2e-6;
      }
      d -= rows(solved(hessian, flat(g)));
    }
  }

 private:
  Eigen::MatrixXd w_, smooth_;
  HeldShape shape_;
  Points rest_;
  std::vector<int> pins_;
  Points targets_;
};

TEST(HoldLattice, SettlesWhereADenseNewtonDoes) {
  const InLattice in(bar(24, 6), {8, 5});
  const std::vector<int> pins{75, 99, 87};
  Points targets = in.rest(pins);
  targets.row(1) << 3.0, 2.5;
  targets.row(2) << 2.2, 0.7;
  LatticeSolver solver = in.solver();
  solver.set_handles(in.handles(pins));
  const Coordinates posed = settled(solver, targets);
  ASSERT_TRUE(solver.report().converged);
  const DenseHold dense(in, pins, targets);
  Points d = solver.points() - in.lattice_rest, g;
  dense.descend(d);
  dense.value(d, g);
  EXPECT_LT(g.cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT(furthest(in.shape.vertices + in.weights * d, posed), 1e-6 * in.diagonal());
  EXPECT_EQ(solver.report().flipped, 0);
}

/// METHODS: the result depends on the shape and not on how finely it is meshed.
TEST(HoldLattice, SplittingHalfOfTheMeshFinerChangesLittle) {
  const Shape coarse = bar(48, 12);
  // Triangles right of the middle are cut in four, and those next to them to fit.
  Shape fine = coarse;
  std::map<std::pair<int, int>, int> middle;
  std::vector<Eigen::RowVector2d> points;
  for (Eigen::Index i = 0; i < coarse.vertices.rows(); ++i) points.emplace_back(coarse.vertices.row(i));
  const auto split = [&](int a, int b) {
    const auto side = std::minmax(a, b);
    const bool cut = points[static_cast<std::size_t>(a)].x() >= 2.0 - 1e-9 &&
                     points[static_cast<std::size_t>(b)].x() >= 2.0 - 1e-9;
    if (!cut) return -1;
    const auto [found, added] =
        middle.try_emplace({side.first, side.second}, static_cast<int>(points.size()));
    if (added) {
      points.push_back(0.5 * (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]));
    }
    return found->second;
  };
  std::vector<std::array<int, 3>> triangles;
  for (Eigen::Index t = 0; t < coarse.triangles.rows(); ++t) {
    const int a = coarse.triangles(t, 0), b = coarse.triangles(t, 1), c = coarse.triangles(t, 2);
    const int ab = split(a, b), bc = split(b, c), ca = split(c, a);
    if (ab >= 0 && bc >= 0 && ca >= 0) {
      triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    } else if (ab < 0 && bc < 0 && ca < 0) {
      triangles.push_back({a, b, c});
    } else if (ab >= 0) {
      triangles.insert(triangles.end(), {{a, ab, c}, {ab, b, c}});
    } else if (bc >= 0) {
      triangles.insert(triangles.end(), {{a, b, bc}, {a, bc, c}});
    } else {
      triangles.insert(triangles.end(), {{a, b, ca}, {ca, b, c}});
    }
  }
  fine.vertices.resize(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t i = 0; i < points.size(); ++i) fine.vertices.row(static_cast<Eigen::Index>(i)) = points[i];
  fine.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    fine.triangles.row(static_cast<Eigen::Index>(i)) << triangles[i][0], triangles[i][1], triangles[i][2];
  }
  ASSERT_GT(fine.triangles.rows(), 2 * coarse.triangles.rows());

  const std::vector<int> pins{0, 588, 342};
  std::vector<Coordinates> results;
  for (const Shape& shape : {coarse, fine}) {
    const InLattice in(shape, {10, 6});
    LatticeSolver solver = in.solver();
    solver.set_handles(in.handles(pins));
    Points targets = in.rest(pins);
    targets.row(2) << 1.5, 3.0;
    settled(solver, targets);
    results.push_back(solver.points());
  }
  const Coordinates& lattice = results[0];
  const double diagonal = (lattice.colwise().maxCoeff() - lattice.colwise().minCoeff()).norm();
  EXPECT_LT(furthest(results[0], results[1]), 0.01 * diagonal);
}

TEST(HoldLattice, NothingTurnsOverInAThousandWildMoves) {
  const InLattice in(grid(13), {6, 6});
  LatticeSolver solver = in.solver();
  const std::vector<int> pins{0, 12, 84, 168, 100};
  solver.set_handles(in.handles(pins));
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    solver.solve(1.5 * random_points(5, seed), no_targets);
    ASSERT_EQ(solver.report().flipped, 0) << seed;
    if (seed % 50 == 0) {
      solver.settle();
      ASSERT_EQ(solver.report().flipped, 0) << seed;
    }
  }
}

TEST(HoldLattice, NothingTurnsOverInWildMovesOfASample) {
  const InLattice in(grid(101), {6, 6});
  LatticeSolver solver = in.solver();
  const std::vector<int> pins{0, 100, 5050, 10200};
  solver.set_handles(in.handles(pins));
  for (unsigned seed = 1; seed <= 40; ++seed) {
    solver.solve(random_points(4, seed), no_targets);
    ASSERT_EQ(solver.report().flipped, 0) << seed;
    ASSERT_FALSE(solver.report().converged);
  }
}

/// A sample leads near to where the whole does, and what settles forgets it.
TEST(HoldLattice, DraggingOnASampleSettlesWhereOneJumpDoes) {
  const InLattice in(bar(120, 30), {10, 6});
  const std::vector<int> pins{15 * 121, 15 * 121 + 120};
  const auto target = [&](double share) {
    Points t = in.rest(pins);
    t.row(1) += share * Eigen::RowVector2d(-1.5, 2.0);
    return t;
  };
  LatticeSolver dragged = in.solver(), jumped = in.solver();
  dragged.set_handles(in.handles(pins));
  jumped.set_handles(in.handles(pins));
  for (int i = 1; i <= 40; ++i) dragged.solve(target(i / 40.0), no_targets);
  for (int i = 0; i < 20; ++i) dragged.solve(target(1.0), no_targets);
  const Coordinates sampled = dragged.positions();
  dragged.settle();
  const Coordinates exact = settled(jumped, target(1.0));
  EXPECT_LT(furthest(dragged.positions(), exact), 1e-4 * in.diagonal());
  EXPECT_LT(furthest(sampled, exact), 0.01 * in.diagonal());
}

TEST(HoldLattice, DescendsTheSameInRefineAndSettle) {
  const InLattice in(bar(24, 6), {8, 5});
  const std::vector<int> pins{75, 99};
  Points targets = in.rest(pins);
  targets.row(1) << 2.5, 2.5;
  LatticeSolver once = in.solver(), steps = in.solver();
  for (LatticeSolver* solver : {&once, &steps}) {
    solver->set_handles(in.handles(pins));
    solver->solve(targets, no_targets);
  }
  once.settle();
  for (int i = 0; i < 100 && !steps.report().converged; ++i) steps.refine();
  EXPECT_TRUE(steps.report().converged);
  EXPECT_LT(furthest(once.positions(), steps.positions()), 1e-12);
}

/// Neighbouring limbs share cells: their pins cannot go apart.
TEST(HoldLattice, PinsOutOfReachAreReportedAndAFinerLatticeHelps) {
  const Shape two = joined(bar(40, 4), moved(bar(40, 4), 0.0, 1.05));
  const std::vector<int> pins{82, 122, 205 + 82, 205 + 122};
  std::vector<double> distance;
  for (const std::vector<int>& count : {std::vector<int>{6, 4}, {16, 20}}) {
    const InLattice in(two, count);
    Points targets = in.rest(pins);
    targets.row(1) += Eigen::RowVector2d(-1.0, -1.8);
    targets.row(3) += Eigen::RowVector2d(-1.0, 1.8);
    LatticeSolver solver = in.solver();
    solver.set_handles(in.handles(pins));
    settled(solver, targets);
    EXPECT_EQ(solver.report().flipped, 0);
    distance.push_back(solver.report().handle_distance.maxCoeff());
    EXPECT_EQ(solver.report().furthest_handle, distance.back());
    std::vector<int> expected;
    for (int h = 0; h < 4; ++h) {
      if (solver.report().handle_distance[h] > 1e-3 * in.diagonal()) expected.push_back(h);
    }
    EXPECT_EQ(solver.report().unreached, expected);
    EXPECT_FALSE(distance.size() == 1 && expected.empty());
  }
  EXPECT_LT(distance[1], 0.5 * distance[0]);
}

TEST(HoldLattice, LockedPointsStayToTheBitAndDraggedOnesGo) {
  const InLattice in(grid(13), {6, 6});
  LatticeSolver solver = in.solver();
  LatticeHandles handles = in.handles({84});
  handles.lattice_points = Eigen::Vector2i(35, 30);
  handles.locked = Eigen::Vector3i(0, 1, 6);
  solver.set_handles(handles);
  Coordinates targets = in.rest({84}).array() + 0.1;
  Coordinates points = in.lattice_rest(std::vector<int>{35, 30}, Eigen::all).array() + 0.2;
  settled(solver, targets, points);
  EXPECT_EQ(solver.report().flipped, 0);
  for (const int p : {0, 1, 6}) EXPECT_EQ(solver.points().row(p), in.lattice_rest.row(p));
  EXPECT_LT((solver.points().row(35) - points.row(0)).norm(), 0.02);
  EXPECT_LT(solver.report().handle_distance[0], 0.01);
}

TEST(HoldLattice, HandlesInsideTrianglesAreTheirCornersMean) {
  const InLattice in(grid(13), {6, 6});
  LatticeSolver solver = in.solver();
  solver.set_handles({inside(in.shape, {10, 200}), {}, {}, {}});
  const Points rest = inside(in.shape, {10, 200}).positions(in.shape.vertices);
  Points targets = rest;
  targets.row(1) += Eigen::RowVector2d(0.1, 0.1);
  const Points posed = settled(solver, targets);
  EXPECT_LT(furthest(inside(in.shape, {10, 200}).positions(posed), targets), 1e-2);
  EXPECT_NEAR((inside(in.shape, {10, 200}).positions(posed) - targets).row(1).norm(),
              solver.report().handle_distance[1], 1e-12);
}

TEST(HoldLattice, WeightsPullHarder) {
  const InLattice in(grid(13), {6, 6});
  std::vector<double> distance;
  for (const double weight : {1.0, 50.0}) {
    LatticeSolver solver = in.solver();
    LatticeHandles handles = in.handles({0, 168});
    handles.weights = Eigen::Vector2d(1.0, weight);
    solver.set_handles(handles);
    Points targets = in.rest({0, 168});
    targets.row(1).array() += 1.0;
    settled(solver, targets);
    distance.push_back(solver.report().handle_distance[1]);
  }
  EXPECT_LT(distance[1], 0.1 * distance[0]);
}

/// The pattern is made once: any other set of handles gives what a new solver gives.
TEST(HoldLattice, HandlesMayChange) {
  const InLattice in(grid(13), {6, 6});
  LatticeSolver solver = in.solver(), fresh = in.solver();
  solver.set_handles(in.handles({0, 168, 90}));
  settled(solver, in.rest({0, 168, 90}).array() * 1.2);
  solver.set_handles(in.handles({5, 100}));
  solver.reset();
  fresh.set_handles(in.handles({5, 100}));
  Points targets = in.rest({5, 100});
  targets.row(0).array() += 0.3;
  EXPECT_EQ(settled(solver, targets), settled(fresh, targets));
}

TEST(HoldLattice, PointsThatNoMeshTouchesFollowSmoothly) {
  // A small mesh in the corner of a large lattice.
  InLattice in(grid(7), {5, 5});
  in.lattice.count = {14, 12};
  in.lattice_rest = points_of(in.lattice);
  in.weights = lattice_weights(in.shape.vertices, in.lattice);
  LatticeSolver solver = in.solver();
  solver.set_handles(in.handles({0, 48}));
  const Coordinates posed = settled(solver, rigid_motion(in.rest({0, 48}), 1.0, 0.0, 0.0));
  EXPECT_LT(furthest(posed, rigid_motion(in.shape.vertices, 1.0, 0.0, 0.0)), 1e-9);
  EXPECT_LT(furthest(solver.points(), rigid_motion(Points(in.lattice_rest), 1.0, 0.0, 0.0)), 1e-6);
}

TEST(HoldLattice, AStateWithTrianglesTurnedOverIsLeft) {
  const InLattice in(grid(13), {6, 6});
  LatticeSolver solver = in.solver();
  solver.set_handles(in.handles({0, 168}));
  Coordinates points = in.lattice_rest;
  points.row(14).swap(points.row(21));
  solver.reset(points);
  EXPECT_GT(solver.report().flipped, 0);
  EXPECT_EQ(solver.points(), points);
  solver.solve(in.rest({0, 168}), no_targets);
  EXPECT_EQ(solver.report().flipped, 0);
}

}  // namespace
}  // namespace planar::testing
