// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "dense.h"
#include "energy/rest_energy.h"
#include "matrices.h"
#include "mesh/triangle_shape.h"
#include "support.h"

namespace planar::testing {
namespace {

/// A mesh with its energy, and dense versions of what it assembles.
struct Case {
  explicit Case(const Shape& shape_, const Eigen::VectorXd& stiffness = {})
      : shape(shape_),
        mesh(shape.vertices.rows(), shape.triangles),
        matrix(mesh, all(mesh.n_vertices)),
        energy(shape.vertices, matrix, flat_triangles(shape.vertices, shape.triangles), stiffness) {}

  Eigen::MatrixXd hessian(const Points& x, bool project) {
    matrix.set_zero();
    energy.add_hessian(x, std::vector<char>(static_cast<std::size_t>(mesh.n_parts), 1), matrix,
                       project ? RestEnergy::Hessian::projected : RestEnergy::Hessian::full);
    return dense(matrix.matrix());
  }

  Eigen::VectorXd gradient(const Points& x) const {
    Points g;
    energy.gradient(x, g);
    return flat(g);
  }

  /// The derivatives of the value and of the gradient by central differences.
  Eigen::VectorXd difference_gradient(const Points& x, double h) const {
    Eigen::VectorXd g(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Points after = x, before = x;
      after.data()[i] += h;
      before.data()[i] -= h;
      g[i] = (energy.value(after) - energy.value(before)) / (2.0 * h);
    }
    return g;
  }
  Eigen::MatrixXd difference_hessian(const Points& x, double h) const {
    Eigen::MatrixXd result(x.size(), x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Points after = x, before = x;
      after.data()[i] += h;
      before.data()[i] -= h;
      result.col(i) = (gradient(after) - gradient(before)) / (2.0 * h);
    }
    return result;
  }

  Shape shape;
  Mesh mesh;
  MeshMatrix matrix;
  RestEnergy energy;
};

/// The shape squeezed, sheared and bent, without inversions.
Points bent(const Points& x) {
  Points y(x.rows(), 2);
  y.col(0) = 0.6 * x.col(0).array() + 0.3 * x.col(1).array() + 0.2 * x.col(1).array().square();
  y.col(1) = 1.3 * x.col(1).array() - 0.3 * x.col(0).array().square();
  return y;
}

Eigen::VectorXd uneven(Eigen::Index m) {
  Eigen::VectorXd stiffness(m);
  for (Eigen::Index t = 0; t < m; ++t) stiffness[t] = 0.01 * std::pow(10.0, t % 5);
  return stiffness;
}

TEST(RestEnergy, GradientAndHessianAreTheDerivatives) {
  const Shape shape = grid(4);
  Case c(shape, uneven(shape.triangles.rows()));
  const Points x = bent(shape.vertices);
  const Eigen::VectorXd g = c.gradient(x);
  // Central differences are off by h² times third derivatives, about 1e5 here, and rounding/h.
  EXPECT_LT((g - c.difference_gradient(x, 1e-6)).norm(), 1e-6 * g.norm());
  const Eigen::MatrixXd h = c.hessian(x, false);
  EXPECT_LT((h - c.difference_hessian(x, 1e-6)).norm(), 1e-6 * h.norm());
  Points ignored;
  EXPECT_NEAR(c.energy.gradient(x, ignored), c.energy.value(x), 1e-12 * c.energy.value(x));
}

TEST(RestEnergy, ProjectionClampsTheEigenvaluesOfEachTriangle) {
  const Points rest = random_points(3, 5);
  const Shape shape{rest, (Triangles(1, 3) << 2, 0, 1).finished()};
  int clamped = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Case c(shape);
    const Points x = 1.5 * random_points(3, 100 + seed);
    const auto sides = [&](const Points& p) {
      return (Eigen::Matrix2d() << (p.row(1) - p.row(0)).transpose(), (p.row(2) - p.row(0)).transpose())
          .finished();
    };
    const Eigen::Matrix2d jacobian = sides(x) * sides(rest).inverse();
    if (jacobian.determinant() < 0.05) continue;
    // METHODS: the Hessian in j = vec J, columns first, from s = |j|², δ = det J.
    // Matrices of a size known to the compiler take it longer.
    const Eigen::VectorXd j = Eigen::Map<const Eigen::VectorXd>(jacobian.data(), 4);
    const double s = j.squaredNorm(), d = jacobian.determinant();
    const Eigen::VectorXd dd = (Eigen::VectorXd(4) << j[3], -j[2], -j[1], j[0]).finished();
    Eigen::MatrixXd ddd = Eigen::MatrixXd::Zero(4, 4);
    ddd(0, 3) = ddd(3, 0) = 1.0;
    ddd(1, 2) = ddd(2, 1) = -1.0;
    const Eigen::MatrixXd mixed = j * dd.transpose();
    const Eigen::MatrixXd h = 2.0 * (1.0 + 1.0 / (d * d)) * Eigen::MatrixXd::Identity(4, 4) -
                              4.0 / std::pow(d, 3) * (mixed + mixed.transpose()) +
                              6.0 * s / std::pow(d, 4) * dd * dd.transpose() - 2.0 * s / std::pow(d, 3) * ddd;
    clamped += eigenvalues(h)[0] < 0.0;
    const Eigen::MatrixXd positive = positive_part(h);
    // vec J in (x0, y0, x1, y1, x2, y2).
    const Eigen::Matrix2d inverse = sides(rest).inverse();
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(4, 6);
    for (int column = 0; column < 2; ++column) {
      for (int axis = 0; axis < 2; ++axis) {
        map(2 * column + axis, 2 + axis) = inverse(0, column);
        map(2 * column + axis, 4 + axis) = inverse(1, column);
        map(2 * column + axis, axis) = -inverse(0, column) - inverse(1, column);
      }
    }
    const double area = 0.5 * std::abs(sides(rest).determinant());
    const Eigen::MatrixXd expected = area * map.transpose() * positive * map;
    EXPECT_LT((c.hessian(x, true) - expected).norm(), 1e-10 * expected.norm()) << seed;
    const Eigen::MatrixXd exact = area * map.transpose() * h * map;
    EXPECT_LT((c.hessian(x, false) - exact).norm(), 1e-10 * exact.norm()) << seed;
  }
  EXPECT_GT(clamped, 3) << "or nothing was tested";
}

TEST(RestEnergy, IsZeroForRigidMotionsOnlyAndInfiniteForACollapse) {
  const Shape shape = grid(4);
  const Case c(shape);
  const Points moved = rigid_motion(shape.vertices, 2.5, 3.0, -1.0);
  EXPECT_NEAR(c.energy.value(moved), 0.0, 1e-12);
  EXPECT_LT(c.gradient(moved).norm(), 1e-11);
  double area = 0.0;
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    const Eigen::RowVector2d a =
        shape.vertices.row(shape.triangles(t, 1)) - shape.vertices.row(shape.triangles(t, 0));
    const Eigen::RowVector2d b =
        shape.vertices.row(shape.triangles(t, 2)) - shape.vertices.row(shape.triangles(t, 0));
    area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  EXPECT_NEAR(c.energy.value(2.0 * shape.vertices), (8.0 + 0.5 - 4.0) * area, 1e-10);
  Points folded = shape.vertices;
  folded.row(5) = shape.vertices.row(6) + Eigen::RowVector2d(0.3, 0.0);
  EXPECT_EQ(c.energy.value(folded), INFINITY);
}

TEST(RestEnergy, FirstCollapseIsTheFirst) {
  const Shape shape = grid(5);
  const Case c(shape);
  const Points x = bent(shape.vertices);
  const auto least_area = [&](const Points& y) {
    double least = INFINITY;
    for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
      const auto area = [&](const Points& p) {
        const Eigen::RowVector2d a = p.row(shape.triangles(t, 1)) - p.row(shape.triangles(t, 0));
        const Eigen::RowVector2d b = p.row(shape.triangles(t, 2)) - p.row(shape.triangles(t, 0));
        return a.x() * b.y() - a.y() * b.x();
      };
      least = std::min(least, area(y) / area(shape.vertices));
    }
    return least;
  };
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Points direction = random_points(25, seed) * (seed % 3 == 0 ? 0.01 : 1.0);
    const double t = c.energy.first_collapse(x, direction);
    ASSERT_GT(t, 0.0);
    for (int k = 0; k < 50; ++k) ASSERT_GT(least_area(x + (0.02 * k * t) * direction), 0.0) << seed;
    ASSERT_NEAR(least_area(x + t * direction), 0.0, 1e-9) << seed;
  }
  // A translation collapses nothing, a linear shrinking everything at once.
  EXPECT_EQ(c.energy.first_collapse(x, Points::Ones(25, 2)), INFINITY);
  EXPECT_NEAR(c.energy.first_collapse(x, -x), 1.0, 1e-6);
}

TEST(RestEnergy, InvertedTrianglesGetAFiniteEnergyThatTurnsThemBack) {
  const Shape shape = grid(4);
  Case c(shape);
  Points x = shape.vertices;
  x.row(5) = shape.vertices.row(6) + Eigen::RowVector2d(0.2, 0.1);
  c.energy.relax(x);
  EXPECT_TRUE(std::isfinite(c.energy.value(x)));
  const Eigen::VectorXd g = c.gradient(x);
  EXPECT_LT((g - c.difference_gradient(x, 1e-6)).norm(), 1e-5 * g.norm());
  const Points downhill = -rows(g);
  EXPECT_LT((downhill.row(5)).dot(x.row(5) - shape.vertices.row(5)), 0.0) << "away from where it belongs";
  const Eigen::MatrixXd h = c.hessian(x, true);
  EXPECT_GT(eigenvalues(h)[0], -1e-9 * h.norm());
  // Come right, they count as all others.
  c.energy.relax(shape.vertices);
  EXPECT_NEAR(c.energy.value(shape.vertices), 0.0, 1e-12);
}

TEST(RestEnergy, FlatTrianglesFollowByStiffnessOfTheirOwn) {
  Shape shape = grid(4);
  shape.vertices.row(5) = 0.5 * (shape.vertices.row(4) + shape.vertices.row(8));  // flat between 4, 5 and 8
  shape.triangles.row(6) << 4, 5, 8;
  Case c(shape);
  const Points moved = rigid_motion(shape.vertices, 2.5, 3.0, -1.0);
  EXPECT_NEAR(c.energy.value(moved), 0.0, 1e-12);
  Points x = shape.vertices + 0.01 * random_points(16, 3);
  c.energy.relax(x);
  const Eigen::VectorXd g = c.gradient(x);
  EXPECT_TRUE(g.allFinite());
  EXPECT_LT((g - c.difference_gradient(x, 1e-7)).norm(), 1e-4 * g.norm());
  const Eigen::MatrixXd h = c.hessian(x, true);
  EXPECT_GT(eigenvalues(h)[0], -1e-9 * h.norm());
}

}  // namespace
}  // namespace planar::testing
