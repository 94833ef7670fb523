// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.h"

namespace planar::testing {

Shape grid(int side, unsigned seed) {
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

Shape joined(const Shape& a, const Shape& b) {
  Shape shape{Points(a.vertices.rows() + b.vertices.rows(), 2),
              Triangles(a.triangles.rows() + b.triangles.rows(), 3)};
  shape.vertices << a.vertices, b.vertices;
  shape.triangles << a.triangles, (b.triangles.array() + static_cast<int>(a.vertices.rows())).matrix();
  return shape;
}

Shape moved(Shape shape, double x, double y) {
  shape.vertices.rowwise() += Eigen::RowVector2d(x, y);
  return shape;
}

Shape ring(int n) {
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

Points random_points(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Points points(n, 2);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = value(random);
  return points;
}

Handles at(const Shape& shape, const std::vector<int>& vertices) {
  return Handles::at_vertices(
      Eigen::Map<const Eigen::VectorXi>(vertices.data(), static_cast<Eigen::Index>(vertices.size())),
      shape.vertices.rows());
}

Handles inside(const Shape& shape, const std::vector<int>& triangles, double a, double b) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights(
      static_cast<Eigen::Index>(triangles.size()), 3);
  weights.rowwise() = Eigen::RowVector3d(a, b, 1.0 - a - b);
  return Handles::in_triangles(
      Eigen::Map<const Eigen::VectorXi>(triangles.data(), static_cast<Eigen::Index>(triangles.size())),
      weights, shape.triangles, shape.vertices.rows());
}

Points rigid_field(const Points& x, double rate, double drift_x, double drift_y) {
  Points u(x.rows(), 2);
  u.col(0) = (-rate * x.col(1)).array() + drift_x;
  u.col(1) = (rate * x.col(0)).array() + drift_y;
  return u;
}

Points rigid_motion(const Points& x, double angle, double dx, double dy) {
  Points y(x.rows(), 2);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const Complex p = std::polar(1.0, angle) * Complex(x(i, 0), x(i, 1)) + Complex(dx, dy);
    y.row(i) << p.real(), p.imag();
  }
  return y;
}

Eigen::VectorXd flat(const Points& u) { return Eigen::Map<const Eigen::VectorXd>(u.data(), u.size()); }

Points rows(const Eigen::VectorXd& u) { return Eigen::Map<const Points>(u.data(), u.size() / 2, 2); }

std::vector<Backend> backends() {
  if (default_backend() == Backend::eigen) return {Backend::eigen};
  return {Backend::cholmod, Backend::eigen};
}

}  // namespace planar::testing
