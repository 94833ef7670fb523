// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/inbetween_support.h"

namespace planar::testing {

Shape bar(int columns, double width) {
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

Points rolled(const Points& straight, double angle) {
  Points result(straight.rows(), 2);
  for (Eigen::Index i = 0; i < straight.rows(); ++i) {
    const double radius = 1.0 / angle, a = straight(i, 0) * angle;
    result.row(i) << (radius - straight(i, 1)) * std::sin(a),
        radius - (radius - straight(i, 1)) * std::cos(a);
  }
  return result;
}

double wrapped_angle(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

Eigen::VectorXd uniform(int frames, double last) { return Eigen::VectorXd::LinSpaced(frames, 0.0, last); }

double largest_difference(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

double largest_difference(const std::vector<Points>& a, const std::vector<Points>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, largest_difference(a[i], b[i]));
  return largest;
}

Edges contour(int n, bool open) {
  Edges edges(open ? n - 1 : n, 2);
  for (int i = 0; i < edges.rows(); ++i) edges.row(i) << i, (i + 1) % n;
  return edges;
}

Sequence bent(unsigned seed) {
  Sequence s;
  s.shape = joined(bar(16), moved(grid(4, seed), 3.0, 0.0));
  const Eigen::Index n = s.shape.vertices.rows() + 1;
  s.shape.vertices.conservativeResize(n, 2);
  s.shape.vertices.row(n - 1) << -1.0, 0.5;
  const auto key = [&](double roll, double turn, double x, double y) {
    Points p = s.shape.vertices;
    if (roll != 0.0) p.topRows(51) = rolled(s.shape.vertices.topRows(51), roll);
    p.middleRows(51, 16) = rigid_motion(s.shape.vertices.middleRows(51, 16), turn, 0.0, y);
    p.row(n - 1) += Eigen::RowVector2d(x * x, y);
    return rigid_motion(p, 0.3 * turn, x, y);
  };
  s.keys = {s.shape.vertices, key(1.0, 0.5, 0.5, 0.2), key(2.4, 1.9, 1.0, 0.7), key(2.0, 2.2, 2.5, 0.1)};
  s.options.key_times = Eigen::Vector4d(0.0, 1.0, 1.5, 4.0);
  s.options.smooth = true;
  return s;
}

}  // namespace planar::testing
