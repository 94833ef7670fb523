// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <set>

#include "dense.h"
#include "lattice/lattice_springs.h"
#include "lattice/lattice_support.h"
#include "lattice/nearest_rotation.h"
#include "lattice/paper_system.h"

namespace planar::testing {
namespace {

TEST(NearestRotation, IsThatOfTheSingularValues) {
  for (unsigned seed = 1; seed <= 500; ++seed) {
    Eigen::Matrix3d s = random_coordinates(3, 3, seed);
    if (seed % 3 == 1) s.col(2) = 0.3 * s.col(0) - s.col(1);  // a plane
    if (seed % 7 == 2) s *= 1e-100;
    const Eigen::Matrix3d r = nearest_rotation(s);
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13) << seed;
    EXPECT_GT(r.determinant(), 0.0);
    EXPECT_LT((r - dense_rotation(s)).norm(), 1e-9) << seed;
    const Eigen::Matrix2d t = random_coordinates(2, 2, seed);
    EXPECT_LT((nearest_rotation(t) - dense_rotation(t)).norm(), 1e-12) << seed;
  }
}

/// Where the rotation is not unique, it is one of the best.
TEST(NearestRotation, OfLinesAndNothingIsOneOfTheBest) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Coordinates p = random_coordinates(2, 3, seed);
    const Eigen::Matrix3d line = p.row(0).transpose() * p.row(1);
    EXPECT_NEAR((nearest_rotation(line) * line).trace(), p.row(0).norm() * p.row(1).norm(), 1e-12);
    const Eigen::Matrix3d mirror = -Eigen::Matrix3d::Identity();
    EXPECT_NEAR((nearest_rotation(mirror) * mirror).trace(), 1.0, 1e-12);
  }
  EXPECT_EQ(nearest_rotation(Eigen::Matrix3d(Eigen::Matrix3d::Zero())), Eigen::Matrix3d::Identity());
  EXPECT_EQ(nearest_rotation(Eigen::Matrix2d(Eigen::Matrix2d::Zero())), Eigen::Matrix2d::Identity());
}

/// Points on a line say how the line turns, and not how things turn about it: the least turn is meant.
TEST(FitMotion, OfALineTurnsNothingAboutIt) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Coordinates ways = random_coordinates(4, 3, seed);
    const Eigen::RowVector3d from = ways.row(0).normalized();
    Eigen::RowVector3d to = ways.row(1).normalized();
    if (seed % 10 == 0) to = from;
    if (seed % 10 == 1) to = -from;
    const Eigen::Vector3d along(-1.0, 0.5, 2.0);
    const Rows<3> p = (along * from).rowwise() + ways.row(2), q = (along * to).rowwise() + ways.row(3);
    const Motion<3> motion = fit_motion<3>(p, q, Eigen::Vector3d(1.0, 2.0, 0.5));
    EXPECT_LT((motion.turn * from.transpose() - to.transpose()).norm(), 1e-9) << seed;
    EXPECT_NEAR(motion.turn.determinant(), 1.0, 1e-12);
    EXPECT_NEAR((motion.turn.trace() - 1.0) / 2.0, from.dot(to), 1e-9)
        << "the angle is that between the lines";
  }
}

/// [LPFFD 9], an iteration in plain dense algebra in P: rotations by singular values, then the normal
/// equations.
struct DensePaper {
  Eigen::MatrixXd rest, lattice_rest;
  Eigen::MatrixXd w;
  WeightedEdges edges;
  std::vector<int> pins, points;
  Eigen::MatrixXd pin_targets, point_targets;
  bool following;
  double shape = 1.0, mesh = 1e2, lattice = 1e2, to_rest = 1e-2;

  Eigen::MatrixXd step(const Eigen::MatrixXd& d) const {
    const Eigen::MatrixXd x = rest + w * d;
    const Eigen::Index n = w.cols();
    std::vector<Eigen::MatrixXd> s(static_cast<std::size_t>(rest.rows()),
                                   Eigen::MatrixXd::Zero(rest.cols(), rest.cols()));
    std::vector<std::array<int, 2>> both = edges.edge;
    std::vector<double> weight(edges.weight.begin(), edges.weight.end());
    for (std::size_t e = 0; e < edges.edge.size(); ++e) {
      both.push_back({edges.edge[e][1], edges.edge[e][0]});
      weight.push_back(weight[e]);
    }
    for (std::size_t e = 0; e < both.size(); ++e) {
      const auto [i, j] = both[e];
      s[static_cast<std::size_t>(i)] +=
          weight[e] * (rest.row(i) - rest.row(j)).transpose() * (x.row(i) - x.row(j));
    }
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n), b = Eigen::MatrixXd::Zero(n, rest.cols());
    for (std::size_t e = 0; e < both.size(); ++e) {
      const auto [i, j] = both[e];
      const Eigen::RowVectorXd row = w.row(i) - w.row(j);
      const Eigen::MatrixXd r = dense_rotation(s[static_cast<std::size_t>(i)]);
      const Eigen::RowVectorXd before = rest.row(i) - rest.row(j);
      // v'_i - v'_j = before + row (P - P⁰)
      a += shape * weight[e] * row.transpose() * row;
      b += shape * weight[e] * row.transpose() * (before * r.transpose() - before + row * lattice_rest);
    }
    for (std::size_t h = 0; h < pins.size(); ++h) {
      const Eigen::RowVectorXd row = w.row(pins[h]);
      a += mesh * row.transpose() * row;
      b += mesh * row.transpose() *
           (pin_targets.row(static_cast<Eigen::Index>(h)) - rest.row(pins[h]) + row * lattice_rest);
    }
    Eigen::MatrixXd goal = lattice_rest;
    if (following) {
      const Eigen::RowVectorXd from = rest.colwise().mean(), to = x.colwise().mean();
      const Eigen::MatrixXd r = dense_rotation((rest.rowwise() - from).transpose() * (x.rowwise() - to));
      goal = ((lattice_rest.rowwise() - from) * r.transpose()).rowwise() + to;
    }
    for (int p = 0; p < n; ++p) {
      const auto found = std::find(points.begin(), points.end(), p);
      const bool dragged = found != points.end();
      if (dragged) goal.row(p) = point_targets.row(found - points.begin());
      const double weight_p = dragged ? lattice : to_rest;
      a(p, p) += weight_p;
      b.row(p) += weight_p * goal.row(p);
    }
    return solved(a, b) - lattice_rest;
  }
};

struct PaperCase {
  bool following, by_area, of_edges;
};
class Paper : public ::testing::TestWithParam<PaperCase> {
 protected:
  template <int D>
  void matches(const Rows<D>& rest, const Triangles& triangles, const LatticeGrid& grid) {
    Elements elements = triangles;
    if (GetParam().of_edges) {
      Edges edges(rest.rows() - 1, 2);
      for (int i = 0; i < edges.rows(); ++i) edges.row(i) << i + 1, i;
      elements = edges;
    }
    const WeightedEdges edges =
        GetParam().by_area ? area_edges(rest, elements) : uniform_edges(rest.rows(), elements);
    const LatticeWeights w = lattice_weights(rest, grid);
    const Rows<D> lattice_rest = points_of(grid);
    DensePaper dense{rest, lattice_rest, w, edges, {0, 7, 20}, {3}, {}, {}, GetParam().following};
    dense.pin_targets = rest(dense.pins, Eigen::all) + Rows<D>(0.5 * random_coordinates(3, D, 5));
    dense.point_targets = lattice_rest(dense.points, Eigen::all).array() + 0.2;

    PaperSystem<D> system(RingEnergy<D>(rest, w, edges), lattice_rest, couplings(w, edges.edge), 1.0, 1e-2,
                          GetParam().following);
    LatticeSprings<D> springs(lattice_rest.rows());
    springs.rows = chosen_rows(w, dense.pins);
    springs.rest = rest(dense.pins, Eigen::all);
    springs.targets = dense.pin_targets;
    springs.weight.setConstant(3, 1e2);
    springs.points = dense.points;
    springs.point_rest = lattice_rest(dense.points, Eigen::all);
    springs.point_targets = dense.point_targets;
    springs.point_weight = 1e2;
    springs.is_point[3] = 1;
    system.compile(springs);

    Rows<D> d = 0.05 * random_coordinates(lattice_rest.rows(), D, 6), next;
    for (int i = 0; i < 5; ++i) {
      const Rows<D> expected = dense.step(d);
      system.step(springs, d, &next);
      EXPECT_LT((next - expected).cwiseAbs().maxCoeff(), 1e-9) << i;
      d = next;
    }
  }
};

TEST_P(Paper, StepIsADenseReadingIn2D) {
  const Shape shape = grid(7);
  matches<2>(shape.vertices, shape.triangles, grid_round(shape.vertices, {5, 6}, LatticeBasis::bspline, 1));
}

/// A surface in space: the grid, bulged.
Rows<3> bulged(const Shape& shape) {
  Rows<3> rest(shape.vertices.rows(), 3);
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    const double x = shape.vertices(i, 0), y = shape.vertices(i, 1);
    rest.row(i) << x, y, 0.5 * std::sin(3.0 * x) * std::cos(2.0 * y);
  }
  return rest;
}

TEST_P(Paper, StepIsADenseReadingIn3D) {
  const Shape shape = grid(7);
  const Rows<3> rest = bulged(shape);
  matches<3>(rest, shape.triangles, grid_round(rest, {4, 5, 4}, LatticeBasis::catmull_rom, 1));
}

INSTANTIATE_TEST_SUITE_P(All, Paper,
                         ::testing::Values(PaperCase{true, true, false}, PaperCase{false, false, false},
                                           PaperCase{true, false, false}, PaperCase{false, true, false},
                                           PaperCase{true, true, true}, PaperCase{false, false, true}));

LatticeOptions paper(bool following, EdgeWeights weights = EdgeWeights::area) {
  LatticeOptions options;
  options.method = LatticeMethodKind::paper;
  options.rigid_following = following;
  options.edge_weights = weights;
  return options;
}

TEST(PaperLattice, OnePinTranslatesWhereThePrintedFormStretches) {
  const InLattice in(grid(13), {8, 7});
  const Coordinates expected = in.shape.vertices.array() + 2.0;
  std::vector<double> off;
  for (const bool following : {true, false}) {
    LatticeSolver solver = in.solver(paper(following));
    solver.set_handles(in.handles({40}));
    solver.solve(in.rest({40}).array() + 2.0, no_targets);
    solver.settle();
    off.push_back((solver.positions() - expected).rowwise().norm().maxCoeff());
  }
  EXPECT_LT(off[0], 1e-9);
  EXPECT_GT(off[1], 0.01);  // [LPFFD, figure 11]
}

TEST(PaperLattice, PinsTurnedTurnAllWithRigidFollowing) {
  const InLattice in(grid(13), {8, 7});
  LatticeSolver solver = in.solver(paper(true));
  const std::vector<int> pins{0, 12, 90, 168};
  solver.set_handles(in.handles(pins));
  for (const double angle : {3.141592653589793 / 2.0, 3.141592653589793}) {
    solver.solve(rigid_motion(in.rest(pins), angle, 1.0, 2.0), no_targets);
    solver.settle();
    EXPECT_LT((solver.positions() - Coordinates(rigid_motion(in.shape.vertices, angle, 1.0, 2.0)))
                  .rowwise()
                  .norm()
                  .maxCoeff(),
              1e-9);
  }
}

TEST(PaperLattice, TurnsRigidlyInSpace) {
  const Shape shape = grid(41);
  const Rows<3> rest = bulged(shape);
  const LatticeGrid grid = grid_round(rest, {6, 6, 5}, LatticeBasis::bspline, 1);
  LatticeSolver solver(rest, shape.triangles, lattice_weights(rest, grid), points_of(grid));
  const Eigen::Matrix3d turn = dense_rotation(random_coordinates(3, 3, 11));
  const std::vector<int> pins{0, 40, 800, 1640};
  solver.set_handles({at(shape, pins), {}, {}, {}});
  const Rows<3> expected = (rest * turn.transpose()).rowwise() + Eigen::RowVector3d(1.0, -2.0, 0.5);
  solver.solve(expected(pins, Eigen::all), no_targets);
  EXPECT_LT((solver.positions() - expected).rowwise().norm().maxCoeff(), 1e-9);
  solver.settle();
  EXPECT_LT((solver.positions() - expected).rowwise().norm().maxCoeff(), 1e-9);
  EXPECT_TRUE(solver.report().converged);
}

/// A sample of rings leads near to where all of them do.
TEST(PaperLattice, DraggingOnASampleIsNearToTheWhole) {
  const Shape shape = grid(81);
  const Rows<3> rest = bulged(shape);
  const LatticeGrid grid = grid_round(rest, {7, 7, 5}, LatticeBasis::bspline, 1);
  LatticeSolver solver(rest, shape.triangles, lattice_weights(rest, grid), points_of(grid));
  const std::vector<int> pins{0, 80, 3280, 6560};
  solver.set_handles({at(shape, pins), {}, {}, {}});
  Rows<3> targets = rest(pins, Eigen::all);
  targets.row(3) += Eigen::RowVector3d(-0.3, -0.2, 0.5);
  for (int i = 0; i < 30; ++i) solver.solve(targets, no_targets);
  const Coordinates sampled = solver.positions();
  EXPECT_FALSE(solver.report().converged);
  solver.settle();
  EXPECT_TRUE(solver.report().converged);
  const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  EXPECT_LT((solver.positions() - sampled).rowwise().norm().maxCoeff(), 0.02 * diagonal);
}

/// Acceleration changes the way, not the end.
TEST(PaperLattice, SettlesWhereThePlainAlternationDoes) {
  const InLattice in(bar(24, 6), {8, 5});
  const std::vector<int> pins{75, 99};
  Points targets = in.rest(pins);
  targets.row(1) << 2.5, 2.0;
  LatticeSolver solver = in.solver(paper(true, EdgeWeights::uniform));
  solver.set_handles(in.handles(pins));
  solver.solve(targets, no_targets);
  solver.settle();
  ASSERT_TRUE(solver.report().converged);
  DensePaper dense{in.shape.vertices,
                   in.lattice_rest,
                   in.weights,
                   uniform_edges(in.shape.vertices.rows(), in.shape.triangles),
                   pins,
                   {},
                   targets,
                   Points(0, 2),
                   true};
  Points d = solver.points() - in.lattice_rest;
  const Points from = d;
  for (int i = 0; i < 30; ++i) d = dense.step(d);
  EXPECT_LT((d - from).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(PaperLattice, EdgesAloneAndFlatModelsInSpaceWork) {
  const Coordinates line = [] {
    Coordinates points(30, 3);
    for (int i = 0; i < 30; ++i) points.row(i) << 0.1 * i, std::sin(0.3 * i), 0.0;
    return points;
  }();
  Edges edges(29, 2);
  for (int i = 0; i < 29; ++i) edges.row(i) << i, i + 1;
  LatticeGrid grid{{6, 4, 1},
                   {LatticeBasis::bspline, LatticeBasis::bspline, LatticeBasis::bspline},
                   Eigen::Vector3d(-1.0, -2.0, 0.0),
                   Eigen::Vector3d(1.0, 1.4, 1.0)};
  LatticeSolver solver(line, edges, lattice_weights(line, grid), points_of(grid));
  LatticeHandles handles;
  handles.mesh = Handles::at_vertices(Eigen::Vector2i(0, 29), 30);
  solver.set_handles(handles);
  Coordinates targets(2, 3);
  targets << line.row(0), line.row(29) + Eigen::RowVector3d(-0.5, 0.5, 0.3);
  solver.solve(targets, no_targets);
  solver.settle();
  EXPECT_TRUE(solver.positions().allFinite());
  EXPECT_LT(solver.report().furthest_handle, 0.2);
}

}  // namespace
}  // namespace planar::testing
