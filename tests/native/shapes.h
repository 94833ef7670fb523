// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "planar/types.h"

namespace planar::benchmarks {

/// A mesh to pose, with the vertices that hold it; the last one is dragged.
struct Shape {
  Points vertices;
  Triangles triangles;
  std::vector<int> pins;
  double diagonal;
};

using Box = std::array<double, 4>;  ///< x and y from, x and y to

/// The cells of a grid that lie in any of the boxes, about n vertices in all, off the grid so that no entry
/// of K is zero by symmetry. `pins` are points; the vertex next to each is taken.
inline Shape grid_shape(const std::vector<Box>& boxes, const std::vector<std::array<double, 2>>& pins,
                        int n) {
  Box all = boxes.front();
  double area = 0.0;
  for (const Box& box : boxes) {
    for (std::size_t axis : {0u, 1u}) {
      all[axis] = std::min(all[axis], box[axis]);
      all[axis + 2] = std::max(all[axis + 2], box[axis + 2]);
    }
    area += (box[2] - box[0]) * (box[3] - box[1]);  // they do not overlap
  }
  const double cell = std::sqrt(area / n);
  const int wide = static_cast<int>(std::lround((all[2] - all[0]) / cell));
  const int high = static_cast<int>(std::lround((all[3] - all[1]) / cell));
  const auto filled = [&](int i, int j) {
    const double x = all[0] + (i + 0.5) * cell, y = all[1] + (j + 0.5) * cell;
    return std::any_of(boxes.begin(), boxes.end(),
                       [&](const Box& b) { return x > b[0] && x < b[2] && y > b[1] && y < b[3]; });
  };
  std::vector<int> number(static_cast<std::size_t>((wide + 1) * (high + 1)), -1);
  std::vector<double> points;
  std::vector<int> corners;
  const auto vertex = [&](int i, int j) {
    int& v = number[static_cast<std::size_t>(j * (wide + 1) + i)];
    if (v < 0) {
      v = static_cast<int>(points.size() / 2);
      points.push_back(all[0] + cell * (i + 0.2 * std::sin(7.0 * v)));
      points.push_back(all[1] + cell * (j + 0.2 * std::cos(3.0 * v)));
    }
    return v;
  };
  for (int j = 0; j < high; ++j) {
    for (int i = 0; i < wide; ++i) {
      if (!filled(i, j)) continue;
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i, j + 1), d = vertex(i + 1, j + 1);
      corners.insert(corners.end(), {a, b, c, b, d, c});
    }
  }
  Shape shape;
  shape.vertices = Eigen::Map<Points>(points.data(), static_cast<Eigen::Index>(points.size() / 2), 2);
  shape.triangles = Eigen::Map<Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  for (const auto& pin : pins) {
    Eigen::Index nearest = 0;
    const Eigen::RowVector2d point(pin[0], pin[1]);
    (shape.vertices.rowwise() - point).rowwise().squaredNorm().minCoeff(&nearest);
    shape.pins.push_back(static_cast<int>(nearest));
  }
  shape.diagonal = (shape.vertices.colwise().maxCoeff() - shape.vertices.colwise().minCoeff()).norm();
  return shape;
}

/// Pins in two corners and two inside.
inline Shape square(int n) {
  return grid_shape({{0, 0, 1, 1}}, {{0, 0}, {1, 1}, {0.5, 0.5}, {0.75, 0.5}}, n);
}

/// A trunk with head, arms and legs, pinned inside its head, hip, feet and hands.
inline Shape figure(int n) {
  return grid_shape({{-1, 0, 1, 4},
                     {-0.3, 4, 0.3, 4.4},
                     {-0.8, 4.4, 0.8, 6},  // trunk, neck, head
                     {-3.8, 3.2, -1, 3.8},
                     {1, 3.2, 3.8, 3.8},  // arms
                     {-0.9, -3.6, -0.2, 0},
                     {0.2, -3.6, 0.9, 0}},  // legs
                    {{0, 5.2}, {0, 0.6}, {-0.55, -3.3}, {0.55, -3.3}, {-3.5, 3.5}, {3.5, 3.5}}, n);
}

}  // namespace planar::benchmarks
