// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/cage_support.h"

#include <map>
#include <numbers>

#include "base/index.h"

namespace planar::testing {

Shape refined(Shape shape, int times) {
  for (; times > 0; --times) {
    std::map<std::pair<int, int>, int> middles;
    std::vector<Eigen::RowVector2d> added;
    const auto middle = [&](int a, int b) {
      const auto next = static_cast<int>(shape.vertices.rows()) + static_cast<int>(added.size());
      const auto [place, is_new] = middles.emplace(std::minmax(a, b), next);
      if (is_new) added.emplace_back(0.5 * (shape.vertices.row(a) + shape.vertices.row(b)));
      return place->second;
    };
    Triangles cut(4 * shape.triangles.rows(), 3);
    for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
      const int a = shape.triangles(t, 0), b = shape.triangles(t, 1), c = shape.triangles(t, 2);
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      cut.middleRows(4 * t, 4) << a, ab, ca, ab, b, bc, bc, c, ca, ab, bc, ca;
    }
    const Eigen::Index n = shape.vertices.rows();
    shape.vertices.conservativeResize(n + static_cast<Eigen::Index>(added.size()), 2);
    for (std::size_t i = 0; i < added.size(); ++i)
      shape.vertices.row(n + static_cast<Eigen::Index>(i)) = added[i];
    shape.triangles = cut;
  }
  return shape;
}

Shape slit_grid(int side) {
  Shape shape = grid(side);
  const int middle = side / 2;
  std::vector<int> right(planar::at(side * side));
  for (int v = 0; v < side * side; ++v) right[planar::at(v)] = v;
  std::vector<Eigen::RowVector2d> added;
  for (int j = middle + 1; j < side; ++j) {
    const int v = j * side + middle;
    shape.vertices(v, 0) = 0.5;
    right[planar::at(v)] = side * side + static_cast<int>(added.size());
    added.emplace_back(shape.vertices.row(v));
  }
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    const auto is_right = [&](int v) { return v < side * side && v % side > middle; };
    bool any = false;
    for (int c = 0; c < 3; ++c) any = any || is_right(shape.triangles(t, c));
    for (int c = 0; any && c < 3; ++c) shape.triangles(t, c) = right[planar::at(shape.triangles(t, c))];
  }
  shape.vertices.conservativeResize(side * side + static_cast<Eigen::Index>(added.size()), 2);
  for (std::size_t i = 0; i < added.size(); ++i)
    shape.vertices.row(side * side + static_cast<Eigen::Index>(i)) = added[i];
  return shape;
}

std::vector<int> leg(const Shape& slit, bool left) {
  std::vector<int> result;
  // Of the vertices along the slit, those of the left leg are in triangles of it.
  std::vector<char> is_left(planar::at(slit.vertices.rows()));
  for (Eigen::Index t = 0; t < slit.triangles.rows(); ++t) {
    double middle = 0.0;
    for (int c = 0; c < 3; ++c) middle += slit.vertices(slit.triangles(t, c), 0) / 3.0;
    for (int c = 0; c < 3; ++c) {
      if (middle < 0.5) is_left[planar::at(slit.triangles(t, c))] = 1;
    }
  }
  for (int v = 0; v < static_cast<int>(slit.vertices.rows()); ++v) {
    if (slit.vertices(v, 1) > 0.6 && (is_left[planar::at(v)] != 0) == left) result.push_back(v);
  }
  return result;
}

Shape overlapping_strip(int columns, int rows) {
  Shape shape{Points((columns + 1) * (rows + 1), 2), Triangles(2 * columns * rows, 3)};
  for (int i = 0; i <= columns; ++i) {
    const double angle = 3.0 * std::numbers::pi * i / columns;
    for (int j = 0; j <= rows; ++j) {
      const double radius = 1.0 + 0.05 * angle / std::numbers::pi + 0.3 * j / rows;
      shape.vertices.row(i * (rows + 1) + j) << radius * std::cos(angle), radius * std::sin(angle);
    }
  }
  int row = 0;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const int a = i * (rows + 1) + j, b = a + rows + 1;
      shape.triangles.row(row++) << a, a + 1, b;
      shape.triangles.row(row++) << a + 1, b + 1, b;
    }
  }
  return shape;
}

}  // namespace planar::testing
