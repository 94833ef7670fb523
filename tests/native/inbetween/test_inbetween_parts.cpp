// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "dense.h"
#include "inbetween/edge_turns.h"
#include "inbetween/frame_assembler.h"
#include "inbetween/inbetween_support.h"
#include "linear/tridiagonal.h"

/// The pieces that in-betweening is made of, each against dense algebra or a closed form.
namespace planar::testing {
namespace {

TEST(Tridiagonal, SolvesLikeADenseFactorization) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (const std::size_t n : {1U, 2U, 7U, 50U}) {
    std::vector<double> diagonal(n);
    std::vector<Complex> below(n - 1), x(n);
    Eigen::MatrixXcd dense =
        Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      dense(i, i) = diagonal[k] = 3.0 + value(random);
      x[k] = Complex(value(random), value(random));
      if (k + 1 == n) continue;
      below[k] = Complex(value(random), 0.5 * value(random));
      dense(i + 1, i) = below[k];
      dense(i, i + 1) = std::conj(below[k]);
    }
    const Eigen::VectorXcd expected =
        least_squares(dense, Eigen::Map<const Eigen::VectorXcd>(x.data(), static_cast<Eigen::Index>(n)));
    solve_tridiagonal(diagonal, below, x);
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_LT(std::abs(x[k] - expected[static_cast<Eigen::Index>(k)]), 1e-12);
    }
  }
}

/// (10), by dense least squares: frames differ by a translation of each part.
TEST(FrameAssembler, MinimisesThePapersEnergy) {
  const Shape shape = joined(grid(4), moved(grid(3, 5), 2.0, 0.0));
  const EdgeGraph graph(shape.vertices.rows(), shape.triangles);
  const auto n_edges = static_cast<Eigen::Index>(graph.edges.size());
  std::mt19937 random(11);
  std::uniform_real_distribution<double> value(0.1, 1.0);
  Eigen::VectorXd weights(n_edges);
  ComplexRows edges(n_edges, FrameAssembler::lanes), points(graph.n_vertices, FrameAssembler::lanes);
  for (Eigen::Index i = 0; i < n_edges; ++i) weights[i] = value(random);
  for (Eigen::Index i = 0; i < edges.size(); ++i) edges.data()[i] = Complex(value(random), value(random));
  FrameAssembler assembler(graph);
  assembler.factorize(weights);
  assembler.assemble(edges, 0, points);

  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n_edges, graph.n_vertices);
  for (Eigen::Index i = 0; i < n_edges; ++i) {
    rows(i, graph.edges[static_cast<std::size_t>(i)][0]) = -std::sqrt(weights[i]);
    rows(i, graph.edges[static_cast<std::size_t>(i)][1]) = std::sqrt(weights[i]);
  }
  const Eigen::MatrixXcd right = weights.cwiseSqrt().asDiagonal() * edges.matrix();
  const Eigen::MatrixXd normal = rows.transpose() * rows;
  const Eigen::MatrixXcd residual = normal * points.matrix() - rows.transpose() * right;
  EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-12);  // the gradient of (10), of numbers of size 1
  EXPECT_LT(std::abs(points(0, 2)), 1e-12);          // held
  EXPECT_LT(std::abs(points(16, 2)), 1e-12);

  ComplexRows one(graph.n_vertices, 1);
  assembler.assemble_one(edges.col(2), one);
  EXPECT_LT((one.col(0) - points.col(2)).abs().maxCoeff(), 1e-12);
}

TEST(FrameAssembler, HoldsIsolatedVertices) {
  const EdgeGraph graph(4, (Edges(1, 2) << 1, 3).finished());
  FrameAssembler assembler(graph);
  assembler.factorize(Eigen::VectorXd::Ones(1));
  ComplexRows points(4, 1);
  assembler.assemble_one(ComplexRows::Constant(1, 1, Complex(2.0, 1.0)), points);
  EXPECT_EQ(points(0, 0), Complex(0.0));
  EXPECT_LT(std::abs(points(3, 0) - points(1, 0) - Complex(2.0, 1.0)), 1e-15);
}

/// Angles of the bar's edges at rest are 0 to π; rolled, an edge at x turns by x times the whole angle.
TEST(EdgeTurns, FollowABarRolledSeveralTimes) {
  const Shape shape = bar(80);
  for (const double angle : {-700.0 * degrees, 100.0 * degrees, 500.0 * degrees}) {
    const Points end = rolled(shape.vertices, angle);
    const EdgeGraph mesh(shape.vertices.rows(), shape.triangles);
    Edges rows(static_cast<Eigen::Index>(mesh.edges.size()), 2);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      rows.row(i) << mesh.edges[static_cast<std::size_t>(i)][0], mesh.edges[static_cast<std::size_t>(i)][1];
    }
    const EdgeGraph soup(shape.vertices.rows(), rows);
    for (const EdgeGraph* graph : {&mesh, &soup}) {
      const Eigen::VectorXd turns = EdgeTurns(*graph).between(shape.vertices, end);
      // Whole turns of the part are left out: the middle turns by half the angle, wrapped.
      const double lift = angle / 2.0 - wrapped(angle / 2.0);
      for (Eigen::Index i = 0; i < turns.size(); ++i) {
        const auto [a, b] = graph->edges[static_cast<std::size_t>(i)];
        const double middle = (shape.vertices(a, 0) + shape.vertices(b, 0)) / 2.0;
        // The bending of a single cell, 500° / 80, is all that may differ.
        EXPECT_NEAR(turns[i], angle * middle - lift, std::abs(angle) / 40.0);
      }
      const Eigen::VectorXd back = EdgeTurns(*graph).between(end, shape.vertices);
      EXPECT_LT((turns + back).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

/// Parts that meet in one vertex are one part, and agree about its turns.
TEST(EdgeTurns, CrossALoneVertex) {
  Points x(5, 2);
  x << 0, 0, 1, 0.2, 1, -0.2, -1, 0.2, -1, -0.2;
  const Triangles triangles = (Triangles(2, 3) << 0, 1, 2, 0, 3, 4).finished();
  Points y = x;
  y.topRows(3) = rigid_motion(x.topRows(3), 170.0 * degrees, 0.0, 0.0);
  y.bottomRows(2) = rigid_motion(x.bottomRows(2), 200.0 * degrees, 0.0, 0.0);
  const EdgeGraph graph(5, triangles);
  const Eigen::VectorXd turns = EdgeTurns(graph).between(x, y);
  EXPECT_NEAR(turns.minCoeff(), (170.0 - 360.0) * degrees, 1e-9);
  EXPECT_NEAR(turns.maxCoeff(), (200.0 - 360.0) * degrees, 1e-9);
}

TEST(EdgeTurns, DoNotDependOnTheTrianglesOrientation) {
  Shape shape = bar(30);
  const Points end = rolled(shape.vertices, 400.0 * degrees);
  const EdgeGraph graph(shape.vertices.rows(), shape.triangles);
  const Eigen::VectorXd turns = EdgeTurns(graph).between(shape.vertices, end);
  for (Eigen::Index t = 0; t < shape.triangles.rows(); t += 3) {
    std::swap(shape.triangles(t, 0), shape.triangles(t, 1));
  }
  const EdgeGraph mixed(shape.vertices.rows(), shape.triangles);
  EXPECT_LT((EdgeTurns(mixed).between(shape.vertices, end) - turns).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace planar::testing
