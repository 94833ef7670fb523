// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "planar/log_spiral.h"
#include "posing/spirals.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double rounding = 1e-12;

TEST(LogSpiral, RigidFieldsMoveRigidlyAtAnyAngleBelowPi) {
  const Shape shape = grid(6);
  for (const double angle : {1e-9, 1e-7, 1e-6, 1e-3, 0.29, 0.31, 1.0, 2.0, 3.1}) {
    // The field of a turn about (0.4, -2).
    const Points u = rigid_field(shape.vertices, angle, -2.0 * angle, -0.4 * angle);
    const Complex centre(0.4, -2.0), drift = centre - std::polar(1.0, angle) * centre;
    const Points expected = rigid_motion(shape.vertices, angle, drift.real(), drift.imag());
    const Points moved = advance_along_spirals(shape.vertices, shape.triangles, u);
    EXPECT_LT((moved - expected).cwiseAbs().maxCoeff(), rounding) << angle;
  }
}

TEST(LogSpiral, ConstantFieldsTranslate) {
  const Shape shape = grid(4);
  const Points moved =
      advance_along_spirals(shape.vertices, shape.triangles, rigid_field(shape.vertices, 0.0, 3.0, -2.0));
  EXPECT_LT((moved - rigid_motion(shape.vertices, 0.0, 3.0, -2.0)).cwiseAbs().maxCoeff(), rounding);
}

TEST(LogSpiral, SimilarityFieldsGiveTheClosedForm) {
  // (14): U = s (p - c) takes p to c + e^s (p - c).
  const Shape shape = grid(5);
  const Complex s(-0.3, 1.2), c(0.2, 0.9);
  Points u(25, 2), expected(25, 2);
  for (int i = 0; i < 25; ++i) {
    const Complex arm = Complex(shape.vertices(i, 0), shape.vertices(i, 1)) - c;
    u.row(i) << (s * arm).real(), (s * arm).imag();
    expected.row(i) << (c + std::exp(s) * arm).real(), (c + std::exp(s) * arm).imag();
  }
  EXPECT_LT((advance_along_spirals(shape.vertices, shape.triangles, u) - expected).cwiseAbs().maxCoeff(),
            rounding);
}

TEST(LogSpiral, IsTheMeanOverEdgesOfThePapersSpirals) {
  // (14)-(16) as written, with the centre of (15) corrected to p - u/s.
  const Shape shape = grid(4);
  const Points u = random_points(16, 7);
  const Mesh mesh(16, shape.triangles);
  std::vector<Complex> sum(16);
  std::vector<int> degree(16);
  const auto at = [](const Points& x, int i) { return Complex(x(i, 0), x(i, 1)); };
  for (const auto& edge : mesh.edges) {
    for (const auto& [i, j] : {std::pair(edge[0], edge[1]), std::pair(edge[1], edge[0])}) {
      const Complex p = at(shape.vertices, i);
      const Complex s = (at(u, i) - at(u, j)) / (p - at(shape.vertices, j));
      const Complex centre = p - at(u, i) / s;
      sum[static_cast<std::size_t>(i)] += centre + std::exp(s) * (p - centre);
      ++degree[static_cast<std::size_t>(i)];
    }
  }
  const Points moved = advance_along_spirals(shape.vertices, shape.triangles, u);
  for (int i = 0; i < 16; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // |s| is up to about 10 here, so positions are up to e^10 in size.
    EXPECT_LT(std::abs(at(moved, i) - sum[k] / static_cast<double>(degree[k])), 1e-9) << i;
  }
}

TEST(LogSpiral, IsolatedVerticesStayAndEdgesOfNoLengthTranslate) {
  Points x(5, 2), u(5, 2);
  x << 0, 0, 1, 0, 0, 1, 0, 1, 7, 7;  // vertices 2 and 3 in one place
  u.rowwise() = Eigen::RowVector2d(0.5, 0.25);
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 1, 2, 3;
  const Points moved = advance_along_spirals(x, triangles, u);
  EXPECT_EQ(moved.row(4), x.row(4));
  EXPECT_LT((moved - x - u).topRows(4).cwiseAbs().maxCoeff(), rounding);
}

TEST(LogSpiral, OverflowIsAnError) {
  const Shape shape = grid(3);
  EXPECT_THROW(advance_along_spirals(shape.vertices, shape.triangles, 1e6 * random_points(9, 1)), SolveError);
}

TEST(LogSpiral, RefusesMismatchedInput) {
  const Shape shape = grid(3);
  EXPECT_REFUSAL(advance_along_spirals(shape.vertices, shape.triangles, Points(8, 2)),
                 "velocities has 8 rows, expected 9");
  Points u = Points::Zero(9, 2);
  u(4, 1) = INFINITY;
  EXPECT_REFUSAL(advance_along_spirals(shape.vertices, shape.triangles, u), "velocities, row 4");
}

TEST(Spirals, SharedFactorsMapATriangleAffinely) {
  // A thin triangle in a turning field: each corner by the mean of the factors is the turn of the field,
  // scaled by one number.
  const Shape shape = grid(4);
  const Mesh mesh(16, shape.triangles);
  Spirals spirals(mesh);
  const Points u = random_points(16, 3);
  EXPECT_GT(spirals.prepare(shape.vertices, u), 0.0);
  Points whole, shared;
  spirals.advance(0.05, whole);
  shared = whole;
  const int* corner = mesh.triangles.data() + 3 * 8;
  spirals.share(corner, shared);
  std::vector<Complex> factor;
  for (int c = 0; c < 3; ++c) {
    const int v = corner[c];
    const Eigen::RowVector2d d = shared.row(v) - shape.vertices.row(v);
    factor.push_back(Complex(d.x(), d.y()) / Complex(u(v, 0), u(v, 1)));
  }
  EXPECT_LT(std::abs(factor[0] - factor[1]), rounding);
  EXPECT_LT(std::abs(factor[0] - factor[2]), rounding);
  for (int v = 0; v < 16; ++v) {
    const bool at_corner = v == corner[0] || v == corner[1] || v == corner[2];
    EXPECT_EQ(shared.row(v) == whole.row(v), !at_corner) << v;
  }
}

}  // namespace
}  // namespace planar::testing
