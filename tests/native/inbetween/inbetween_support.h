// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "planar/inbetween.h"
#include "support.h"

/// Shapes and measures that the tests of in-betweening share.
namespace planar::testing {

constexpr double degrees = std::numbers::pi / 180.0;

/// A bar of length 1 and width `width`, lying along x, of `columns`×(2 rows of cells).
inline Shape bar(int columns, double width = 0.08) {
  Shape shape{Points(3 * (columns + 1), 2), Triangles(4 * columns, 3)};
  for (int i = 0; i <= columns; ++i) {
    for (int j = 0; j < 3; ++j) {
      shape.vertices.row(3 * i + j) << static_cast<double>(i) / columns, width * (j - 1) / 2.0;
    }
  }
  int row = 0;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < 2; ++j) {
      const int a = 3 * i + j, b = a + 3;
      shape.triangles.row(row++) << a, b, a + 1;
      shape.triangles.row(row++) << b, b + 1, a + 1;
    }
  }
  return shape;
}

/// The bar bent along its length into an arc of `angle`; its middle line keeps its length.
inline Points rolled(const Points& straight, double angle) {
  Points result(straight.rows(), 2);
  for (Eigen::Index i = 0; i < straight.rows(); ++i) {
    const double radius = 1.0 / angle, a = straight(i, 0) * angle;
    result.row(i) << (radius - straight(i, 1)) * std::sin(a),
        radius - (radius - straight(i, 1)) * std::cos(a);
  }
  return result;
}

inline double wrapped_angle(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

inline Eigen::VectorXd uniform(int frames, double last = 1.0) {
  return Eigen::VectorXd::LinSpaced(frames, 0.0, last);
}

inline double largest_difference(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

inline double largest_difference(const std::vector<Points>& a, const std::vector<Points>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, largest_difference(a[i], b[i]));
  return largest;
}

/// A bar that is bent, turned and moved.
struct Bending {
  Shape shape = bar(30);
  std::vector<Points> frames =
      inbetween({shape.vertices, rigid_motion(rolled(shape.vertices, 200.0 * degrees), 0.4, 2.0, 1.0)},
                uniform(9), shape.triangles);
};

/// The sides of a closed contour or, if `open`, all but the last.
inline Edges contour(int n, bool open = false) {
  Edges edges(open ? n - 1 : n, 2);
  for (int i = 0; i < edges.rows(); ++i) edges.row(i) << i, (i + 1) % n;
  return edges;
}

}  // namespace planar::testing
