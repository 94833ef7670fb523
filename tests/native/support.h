// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include "linear/sparse_solver.h"
#include "mesh/mesh.h"
#include "planar/akvf.h"
#include "planar/handle.h"

/// Meshes, fields and dense algebra that the tests compare with.
/// The call throws std::invalid_argument with these words in its message.
#define EXPECT_REFUSAL(call, words)                                                      \
  try {                                                                                  \
    (void)(call);                                                                        \
    ADD_FAILURE() << "accepted: " #call;                                                 \
  } catch (const std::invalid_argument& error) {                                         \
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what(); \
  }

namespace planar::testing {

using Complex = std::complex<double>;

struct Shape {
  Points vertices;
  Triangles triangles;
};

/// A unit square of side×side vertices, its vertices moved about by up to a fifth of a cell, alternate
/// triangles turned round.
inline Shape grid(int side, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  Shape shape{Points(side * side, 2), Triangles(2 * (side - 1) * (side - 1), 3)};
  for (int i = 0; i < side * side; ++i) {
    shape.vertices.row(i) << (i % side + jitter(random)) / (side - 1),
        (i / side + jitter(random)) / (side - 1);
  }
  int row = 0;
  for (int j = 0; j + 1 < side; ++j) {
    for (int i = 0; i + 1 < side; ++i) {
      const int a = j * side + i;
      shape.triangles.row(row++) << a, a + 1, a + side;
      shape.triangles.row(row++) << a + 1, a + side, a + side + 1;
    }
  }
  return shape;
}

/// Both shapes as one mesh, the second one after the first.
inline Shape joined(const Shape& a, const Shape& b) {
  Shape shape{Points(a.vertices.rows() + b.vertices.rows(), 2),
              Triangles(a.triangles.rows() + b.triangles.rows(), 3)};
  shape.vertices << a.vertices, b.vertices;
  shape.triangles << a.triangles, (b.triangles.array() + static_cast<int>(a.vertices.rows())).matrix();
  return shape;
}

inline Shape moved(Shape shape, double x, double y) {
  shape.vertices.rowwise() += Eigen::RowVector2d(x, y);
  return shape;
}

/// A ring of two rows of `n` vertices: a mesh all of whose vertices are on the boundary, with a hole.
inline Shape ring(int n) {
  Shape shape{Points(2 * n, 2), Triangles(2 * n, 3)};
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * 3.141592653589793 * i / n;
    shape.vertices.row(i) << std::cos(a), std::sin(a);
    shape.vertices.row(n + i) << 0.6 * std::cos(a), 0.6 * std::sin(a);
    const int next = (i + 1) % n;
    shape.triangles.row(2 * i) << i, next, n + i;
    shape.triangles.row(2 * i + 1) << next, n + next, n + i;
  }
  return shape;
}

inline Points random_points(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Points points(n, 2);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = value(random);
  return points;
}

inline Handles at(const Shape& shape, const std::vector<int>& vertices) {
  return Handles::at_vertices(
      Eigen::Map<const Eigen::VectorXi>(vertices.data(), static_cast<Eigen::Index>(vertices.size())),
      shape.vertices.rows());
}

inline Handles inside(const Shape& shape, const std::vector<int>& triangles, double a = 0.2, double b = 0.3) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights(
      static_cast<Eigen::Index>(triangles.size()), 3);
  weights.rowwise() = Eigen::RowVector3d(a, b, 1.0 - a - b);
  return Handles::in_triangles(
      Eigen::Map<const Eigen::VectorXi>(triangles.data(), static_cast<Eigen::Index>(triangles.size())),
      weights, shape.triangles, shape.vertices.rows());
}

/// Velocities of the rigid field that turns with `rate` about the origin and drifts.
inline Points rigid_field(const Points& x, double rate, double drift_x, double drift_y) {
  Points u(x.rows(), 2);
  u.col(0) = (-rate * x.col(1)).array() + drift_x;
  u.col(1) = (rate * x.col(0)).array() + drift_y;
  return u;
}

/// x turned by `angle` about the origin, then moved.
inline Points rigid_motion(const Points& x, double angle, double dx, double dy) {
  Points y(x.rows(), 2);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const Complex p = std::polar(1.0, angle) * Complex(x(i, 0), x(i, 1)) + Complex(dx, dy);
    y.row(i) << p.real(), p.imag();
  }
  return y;
}

/// P of (5)-(7), dense, in unknowns (x0, y0, x1, y1, ...), straight from the hat functions' gradients.
inline Eigen::MatrixXd dense_p(const Points& x, const Triangles& triangles,
                               const Eigen::VectorXd& stiffness = {}) {
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(3 * triangles.rows(), 2 * x.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) corners.row(c) << 1.0, x(triangles(t, c), 0), x(triangles(t, c), 1);
    const Eigen::Matrix3d coefficients =
        corners.inverse();  // of the hat functions 1, x, y; a column for each corner
    const double weight =
        std::sqrt(std::abs(corners.determinant()) / 2.0 * (stiffness.size() ? stiffness[t] : 1.0));
    for (int c = 0; c < 3; ++c) {
      const double gx = weight * coefficients(1, c), gy = weight * coefficients(2, c);
      const Eigen::Index u = 2 * triangles(t, c), v = u + 1;
      p(3 * t, u) = 2.0 * gx;
      p(3 * t + 1, u) = std::sqrt(2.0) * gy;
      p(3 * t + 1, v) = std::sqrt(2.0) * gx;
      p(3 * t + 2, v) = 2.0 * gy;
    }
  }
  return p;
}

inline Eigen::MatrixXd dense_k(const Points& x, const Triangles& triangles,
                               const Eigen::VectorXd& stiffness = {}) {
  const Eigen::MatrixXd p = dense_p(x, triangles, stiffness);
  return p.transpose() * p;
}

/// C: 2k×2n, takes a field to the handles.
inline Eigen::MatrixXd dense_c(const Handles& handles, Eigen::Index n) {
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(2 * handles.size(), 2 * n);
  for (Eigen::Index i = 0; i < handles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      c(2 * i, 2 * handles.vertices(i, corner)) += handles.weights(i, corner);
      c(2 * i + 1, 2 * handles.vertices(i, corner) + 1) += handles.weights(i, corner);
    }
  }
  return c;
}

inline Eigen::VectorXd flat(const Points& u) { return Eigen::Map<const Eigen::VectorXd>(u.data(), u.size()); }

inline Points rows(const Eigen::VectorXd& u) { return Eigen::Map<const Points>(u.data(), u.size() / 2, 2); }

/// (7), by dense algebra.
inline Points dense_soft(const Shape& shape, const Handles& handles, const Points& velocities,
                         double pin_weight, const Eigen::VectorXd& stiffness = {}) {
  const Eigen::MatrixXd c = dense_c(handles, shape.vertices.rows());
  const Eigen::MatrixXd k = dense_k(shape.vertices, shape.triangles, stiffness);
  return rows(
      (k + pin_weight * c.transpose() * c).ldlt().solve(pin_weight * c.transpose() * flat(velocities)));
}

/// (8), by dense algebra: the field keeps its values on the boundary.
inline Points dense_dirichlet(const Shape& shape, const Points& field,
                              const Eigen::VectorXd& stiffness = {}) {
  const Mesh mesh(shape.vertices.rows(), shape.triangles);
  const Eigen::MatrixXd k = dense_k(shape.vertices, shape.triangles, stiffness);
  std::vector<int> inner, outer;
  for (int v = 0; v < mesh.n_vertices; ++v) {
    auto& side = mesh.interior[static_cast<std::size_t>(v)] ? inner : outer;
    side.insert(side.end(), {2 * v, 2 * v + 1});
  }
  Eigen::VectorXd u = flat(field);
  const Eigen::MatrixXd inner_k = k(inner, inner);
  const Eigen::MatrixXd coupling = k(inner, outer);
  const Eigen::VectorXd right = -coupling * Eigen::VectorXd(u(outer));
  u(inner) = inner_k.ldlt().solve(right).eval();
  return rows(u);
}

inline std::vector<Backend> backends() {
  if (default_backend() == Backend::eigen) return {Backend::eigen};
  return {Backend::cholmod, Backend::eigen};
}

}  // namespace planar::testing
