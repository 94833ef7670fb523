// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "dense.h"
#include "lattice/lattice_frame.h"
#include "lattice/lattice_support.h"

namespace planar::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

LatticeSolver made(const Coordinates& rest, const LatticeSolver::Elements& elements,
                   const LatticeWeights& weights, const Coordinates& lattice_rest,
                   const LatticeOptions& options = {}) {
  return {rest, elements, weights, lattice_rest, options};
}

class Hostile : public ::testing::Test {
 protected:
  InLattice in{grid(9), {5, 6}};
  Coordinates rest{in.shape.vertices};
  Triangles triangles{in.shape.triangles};
};

TEST_F(Hostile, ConstructorNamesWhatIsWrong) {
  const auto& p = in.lattice_rest;
  const auto& w = in.weights;
  EXPECT_REFUSAL(made(Coordinates(0, 2), triangles, w, p), "rest is empty");
  EXPECT_REFUSAL(made(Coordinates(81, 4), triangles, w, p), "rest has 4 columns");
  Coordinates bad = rest;
  bad(5, 1) = nan;
  EXPECT_REFUSAL(made(bad, triangles, w, p), "rest, row 5: not a finite number");
  EXPECT_REFUSAL(made(rest, Triangles(0, 3), w, p), "elements is empty");
  EXPECT_REFUSAL(made(rest, Edges(0, 2), w, p), "elements is empty");
  Triangles out = triangles;
  out(3, 2) = 81;
  EXPECT_REFUSAL(made(rest, out, w, p), "triangles, row 3: vertex 81 is out of range");
  Edges loop(2, 2);
  loop << 0, 1, 4, 4;
  EXPECT_REFUSAL(made(rest, std::move(loop), w, p), "edges, row 1: names a vertex twice");
  EXPECT_REFUSAL(made(rest, triangles, LatticeWeights(80, 30), p), "weights has 80 rows");
  EXPECT_REFUSAL(made(rest, triangles, LatticeWeights(81, 31), p), "weights has 31 columns");
  LatticeWeights not_finite = w;
  not_finite.coeffRef(7, not_finite.innerIndexPtr()[not_finite.outerIndexPtr()[7]]) = nan;
  EXPECT_REFUSAL(made(rest, triangles, not_finite, p), "weights, row 7: not a finite number");
  EXPECT_REFUSAL(made(rest, triangles, w, Coordinates(0, 2)), "lattice_rest is empty");
  EXPECT_REFUSAL(made(rest, triangles, w, Coordinates::Zero(30, 3)), "lattice_rest has 3 columns");
  Coordinates bent = p;
  bent(17, 0) += 0.1;
  EXPECT_REFUSAL(made(rest, triangles, w, bent), "lattice_rest, row 17: not a point of a regular grid");
}

TEST_F(Hostile, OptionsAreChecked) {
  LatticeOptions options;
  options.method = LatticeMethodKind::hold;
  Edges edges(1, 2);
  edges << 0, 1;
  EXPECT_REFUSAL(made(rest, std::move(edges), in.weights, in.lattice_rest, options),
                 "method: 'hold' needs triangles");
  options = {};
  options.weight_shape = 0.0;
  EXPECT_REFUSAL(in.solver(options), "weight_shape must be a finite number above 0");
  options = {};
  options.weight_mesh = nan;
  EXPECT_REFUSAL(in.solver(options), "weight_mesh");
  options = {};
  options.weight_lattice = -1.0;
  EXPECT_REFUSAL(in.solver(options), "weight_lattice");
  options = {};
  options.weight_rest = -1.0;
  EXPECT_REFUSAL(in.solver(options), "weight_rest must be a finite number not below 0");
}

TEST_F(Hostile, AFailedCallChangesNothing) {
  LatticeSolver solver = in.solver(), same = in.solver();
  const Points targets = in.rest({0, 80}).array() * 1.3;
  for (LatticeSolver* s : {&solver, &same}) {
    s->set_handles(in.handles({0, 80}));
    s->solve(targets, no_targets);
  }
  LatticeHandles handles = in.handles({3});
  handles.lattice_points = Eigen::Vector2i(4, 30);
  EXPECT_REFUSAL(solver.set_handles(handles), "lattice_points, row 1: point 30 is out of range");
  handles.lattice_points = Eigen::Vector2i(4, 5);
  handles.locked = Eigen::Vector2i(6, 4);
  EXPECT_REFUSAL(solver.set_handles(handles), "locked, row 1: point 4 is named twice");
  handles = in.handles({3});
  handles.weights = Eigen::Vector2d(1.0, 1.0);
  EXPECT_REFUSAL(solver.set_handles(handles), "weights has 2 rows");
  handles.weights = Eigen::VectorXd::Constant(1, -1.0);
  EXPECT_REFUSAL(solver.set_handles(handles), "weights, row 0");
  Coordinates bad = targets;
  bad(1, 0) = nan;
  EXPECT_REFUSAL(solver.solve(bad, no_targets), "vertex_targets, row 1");
  EXPECT_REFUSAL(solver.solve(targets.topRows(1), no_targets), "vertex_targets has 1 rows");
  EXPECT_REFUSAL(solver.solve(targets, targets), "lattice_targets has 2 rows");
  EXPECT_REFUSAL(solver.solve(Coordinates::Zero(2, 3), no_targets), "vertex_targets has 3 columns");
  EXPECT_REFUSAL(solver.reset(Coordinates::Zero(29, 2)), "points has 29 rows");
  EXPECT_THROW(solver.solve(1e300 * targets, no_targets), SolveError);
  EXPECT_EQ(solver.points(), same.points());
  EXPECT_EQ(solver.report().iterations, same.report().iterations);
  EXPECT_EQ(solver.settle(), same.settle());
}

TEST_F(Hostile, WithoutHandlesOrTargetsNothingMoves) {
  LatticeSolver solver = in.solver();
  EXPECT_EQ(solver.settle(), in.lattice_rest);
  EXPECT_EQ(solver.refine(), in.lattice_rest);
  EXPECT_EQ(solver.solve(no_targets, no_targets), in.lattice_rest);
  solver.set_handles(in.handles({0, 80}));
  EXPECT_EQ(solver.settle(), in.lattice_rest);
}

TEST_F(Hostile, SizesAndPlacesDoNotMatter) {
  const Points targets = in.rest({0, 80, 44}) + 0.3 * random_points(3, 1);
  LatticeSolver plain = in.solver();
  plain.set_handles(in.handles({0, 80, 44}));
  plain.solve(targets, no_targets);
  plain.settle();
  for (const double scale : {1e-12, 1e9}) {
    LatticeSolver solver = made(scale * rest, triangles, in.weights, scale * in.lattice_rest);
    solver.set_handles(in.handles({0, 80, 44}));
    solver.solve(scale * targets, no_targets);
    solver.settle();
    EXPECT_LT((solver.positions() / scale - plain.positions()).cwiseAbs().maxCoeff(), 1e-6) << scale;
  }
  const Eigen::RowVector2d away(1e4, -1e4);
  LatticeSolver far = made(rest.rowwise() + away, triangles, in.weights, in.lattice_rest.rowwise() + away);
  far.set_handles(in.handles({0, 80, 44}));
  far.solve(targets.rowwise() + away, no_targets);
  far.settle();
  EXPECT_LT(((far.positions().rowwise() - away) - plain.positions()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(Hostile, DegenerateModelsAndLattices) {
  // Weights that are all 0: nothing can be moved.
  LatticeSolver deaf = made(rest, triangles, LatticeWeights(81, 30), in.lattice_rest);
  deaf.set_handles(in.handles({0, 80}));
  deaf.solve(in.rest({0, 80}).array() + 1.0, no_targets);
  EXPECT_EQ(deaf.positions(), rest);
  EXPECT_EQ(deaf.report().unreached.size(), 2u);
  // One point: all it can do is translate.
  LatticeWeights one(81, 1);
  for (int i = 0; i < 81; ++i) one.insert(i, 0) = 1.0;
  LatticeSolver single = made(rest, triangles, one, Coordinates::Zero(1, 2));
  single.set_handles(in.handles({0, 80}));
  single.solve(in.rest({0, 80}).array() + 1.0, no_targets);
  single.settle();
  EXPECT_LT((single.positions() - (rest.array() + 1.0).matrix()).cwiseAbs().maxCoeff(), 1e-6);
  // A mesh in one place, and one without area.
  for (const double height : {0.0, 1.0}) {
    Coordinates flat = Coordinates::Zero(81, 2);
    flat.col(1) = height * rest.col(1);
    for (const LatticeMethodKind kind : {LatticeMethodKind::hold, LatticeMethodKind::paper}) {
      LatticeOptions options;
      options.method = kind;
      LatticeSolver solver = made(flat, triangles, in.weights, in.lattice_rest, options);
      solver.set_handles(in.handles({0, 80}));
      solver.solve(in.rest({0, 80}), no_targets);
      solver.settle();
      EXPECT_TRUE(solver.positions().allFinite());
    }
  }
}

TEST_F(Hostile, ChaosOfTargetsNeverCrashes) {
  for (const LatticeMethodKind kind : {LatticeMethodKind::hold, LatticeMethodKind::paper}) {
    LatticeOptions options;
    options.method = kind;
    LatticeSolver solver = in.solver(options);
    solver.set_handles(in.handles({0, 80, 44, 44}));
    for (unsigned seed = 1; seed <= 60; ++seed) {
      const double size = std::pow(10.0, static_cast<double>(seed % 60) * 5.0 - 10.0);
      try {
        solver.solve(size * random_points(4, seed), no_targets);
        solver.refine();
      } catch (const SolveError&) {
      }
      ASSERT_TRUE(solver.positions().allFinite());
    }
  }
}

TEST(LatticeFrame, ReadsGridsThatAreTurnedSkewAndLayered) {
  const auto frame_of = [](const std::array<int, 3>& n, const Eigen::MatrixXd& steps) {
    Coordinates points(n[0] * n[1] * n[2], steps.cols());
    for (int i = 0; i < points.rows(); ++i) {
      points.row(i) = Eigen::RowVector3d(i % n[0], i / n[0] % n[1], i / (n[0] * n[1])) * steps;
      points.row(i).array() += 5.0;
    }
    return LatticeFrame(points);
  };
  Eigen::MatrixXd skew(3, 2), space(3, 3);
  skew << 1.0, 0.5, -0.2, -2.0, 0.0, 0.0;
  space << 1.0, 0.5, 0.0, -0.2, -2.0, 0.3, 0.0, 1.0, 1.0;
  EXPECT_EQ(frame_of({4, 3, 1}, skew).count(), (std::array{4, 3, 1}));
  EXPECT_EQ(frame_of({4, 3, 2}, skew).count(), (std::array{4, 3, 2}));
  EXPECT_EQ(frame_of({2, 5, 3}, space).count(), (std::array{2, 5, 3}));
  EXPECT_EQ(frame_of({1, 1, 1}, space).count(), (std::array{1, 1, 1}));
  const Coordinates place = Eigen::RowVector3d(1.5, 2.0, 0.25) * space;
  const Coordinates moved = place.array() + 5.0;
  EXPECT_LT((frame_of({2, 5, 3}, space).in_steps(moved) - Eigen::RowVector3d(1.5, 2.0, 0.25)).norm(), 1e-12);
}

TEST(SecondDifferences, AreZeroForAffineMotionsAloneAndKeepAllElse) {
  const std::vector<Difference> differences = second_differences({4, 3, 3});
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(differences.size()), 36);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t k = 0; k < differences[i].point.size(); ++k) {
      m(static_cast<Eigen::Index>(i), differences[i].point[k]) += differences[i].coefficient[k];
    }
  }
  EXPECT_EQ(rank(m), 36 - 4);
}

}  // namespace
}  // namespace planar::testing
