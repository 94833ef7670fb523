// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/interior.h"

#include <cmath>

#include "cutout/contour.h"
#include "mesh/triangle_shape.h"

namespace planar {
namespace {

/// From one lattice to the next.
constexpr double finer_lattice = 1.25;
/// Of a lattice's edge: the least distance from the outline, and from other points.
constexpr double from_outline = 0.45, spacing = 0.72;

/// Points by squares of the plane.
class Buckets {
 public:
  Buckets(int width, int height, double side) : side_(side), buckets_(count(width), count(height)) {}

  void add(const Eigen::RowVector2d& p) { buckets_(cell(p[0]), cell(p[1])).push_back(p); }

  /// `radius` is the side at most.
  bool any_within(const Eigen::RowVector2d& p, double radius) const {
    const int x = cell(p[0]), y = cell(p[1]);
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, buckets_.height() - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, buckets_.width() - 1); ++i) {
        for (const Eigen::RowVector2d& q : buckets_(i, j)) {
          if ((q - p).squaredNorm() <= radius * radius) return true;
        }
      }
    }
    return false;
  }

 private:
  int count(int size) const { return static_cast<int>(size / side_) + 1; }
  int cell(double v) const { return static_cast<int>(v / side_); }

  double side_;
  Grid<std::vector<Eigen::RowVector2d>> buckets_;
};

}  // namespace

Points interior_points(const Points& boundary, const Grid<float>& distance, const Grid<float>& size,
                       double shortest, double longest) {
  Buckets near(distance.width(), distance.height(), spacing * longest);
  for (Eigen::Index i = 0; i < boundary.rows(); ++i) near.add(boundary.row(i));

  std::vector<Eigen::RowVector2d> kept;
  for (double edge = longest, above = 2.0 * longest;;
       above = edge, edge = std::max(shortest, edge / finer_lattice)) {
    const bool last = edge <= shortest;
    const double low = last ? 0.0 : 0.995 * edge, high = 0.995 * above;
    const double row_height = std::sqrt(0.75) * edge;
    const auto n_rows = static_cast<int>((distance.height() - 1) / row_height) + 1;
    const auto n_columns = static_cast<int>((distance.width() - 1) / edge) + 1;
    for (int j = 0; j < n_rows; ++j) {
      for (int i = 0; i < n_columns; ++i) {
        const Eigen::RowVector2d p((i + 0.5 * (j % 2)) * edge, j * row_height);
        if (sample(distance, p[0], p[1]) <= from_outline * edge) continue;
        const double s = sample(size, p[0], p[1]);
        if (s < low || s >= high || near.any_within(p, spacing * edge)) continue;
        near.add(p);
        kept.push_back(p);
      }
    }
    if (last) break;
  }
  return rows_of(kept);
}

Points gap_points(const Points& points, const Triangles& triangles, const Grid<float>& distance,
                  const Grid<float>& size, double longest) {
  Buckets near(distance.width(), distance.height(), spacing * longest);
  std::vector<Eigen::RowVector2d> kept;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector2d a = points.row(triangles(t, 0));
    const Eigen::RowVector2d u = points.row(triangles(t, 1)) - a, v = points.row(triangles(t, 2)) - a;
    const double area = doubled_area(points, triangles.data() + 3 * t);
    if (area <= 0.0) continue;
    const Eigen::RowVector2d w = v.squaredNorm() * u - u.squaredNorm() * v;
    const Eigen::RowVector2d to_centre = Eigen::RowVector2d(-w[1], w[0]) / (2.0 * area);
    const Eigen::RowVector2d p = a + to_centre;
    const double s = sample(size, p[0], p[1]);
    if (to_centre.norm() <= spacing * s || sample(distance, p[0], p[1]) <= from_outline * s) continue;
    if (near.any_within(p, spacing * s)) continue;
    near.add(p);
    kept.push_back(p);
  }
  return rows_of(kept);
}

}  // namespace planar
