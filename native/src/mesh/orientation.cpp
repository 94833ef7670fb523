// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/orientation.h"

#include <algorithm>
#include <limits>

namespace planar {

namespace {

/// Twice the signed area of the triangle of corners at coordinate(vertex, axis).
double doubled_area(const int* corner, const auto& coordinate) {
  const double ax = coordinate(corner[1], 0) - coordinate(corner[0], 0);
  const double ay = coordinate(corner[1], 1) - coordinate(corner[0], 1);
  const double bx = coordinate(corner[2], 0) - coordinate(corner[0], 0);
  const double by = coordinate(corner[2], 1) - coordinate(corner[0], 1);
  return ax * by - ay * bx;
}

/// Differences and products of float32 values are exact, or nearly so, in double.
double doubled_area_in_float32(const Points& x, const Eigen::RowVector2d& origin, const int* corner) {
  return doubled_area(corner, [&](int i, int axis) {
    return static_cast<double>(static_cast<float>(x(i, axis) + origin[axis]));
  });
}

}  // namespace

Orientation::Orientation(const Points& rest, const Triangles& triangles, const Eigen::RowVector2d& origin)
    : triangles_(triangles), origin_(origin), sign_(static_cast<std::size_t>(triangles.rows())) {
  for (std::size_t t = 0; t < sign_.size(); ++t) {
    const int* corner = triangles_.data() + 3 * t;
    const double area = doubled_area_in_float32(rest, Eigen::RowVector2d::Zero(), corner);
    double coordinate = 0.0, side = 0.0;
    for (int c = 0; c < 3; ++c) {
      coordinate = std::max(coordinate, rest.row(corner[c]).cwiseAbs().maxCoeff());
      side = std::max(side, (rest.row(corner[c]) - rest.row(corner[(c + 1) % 3])).norm());
    }
    const double rounding = 4.0 * std::numeric_limits<float>::epsilon() * coordinate * side;
    sign_[t] = static_cast<double>((area > rounding) - (area < -rounding));
  }
}

double Orientation::area_as_at_rest(const Points& x, std::size_t t) const {
  return sign_[t] == 0.0 ? 0.0 : sign_[t] * doubled_area_in_float32(x, origin_, triangles_.data() + 3 * t);
}

void Orientation::measure(const Points& x, std::vector<double>& area) const {
  area.resize(sign_.size());
  for (std::size_t t = 0; t < sign_.size(); ++t) area[t] = sign_[t] == 0.0 ? 1.0 : area_as_at_rest(x, t);
}

void Orientation::measure_exactly(const Points& x, std::vector<double>& area) const {
  area.resize(sign_.size());
  const auto exact = [&x](int i, int axis) { return x(i, axis); };
  for (std::size_t t = 0; t < sign_.size(); ++t)
    area[t] = sign_[t] == 0.0 ? 1.0 : sign_[t] * doubled_area(triangles_.data() + 3 * t, exact);
}

Flags Orientation::flipped(const Points& x) const {
  Flags result(triangles_.rows());
  for (std::size_t t = 0; t < sign_.size(); ++t)
    result[static_cast<Eigen::Index>(t)] = area_as_at_rest(x, t) < 0.0;
  return result;
}

int Orientation::count_flipped(const Points& x) const {
  int flipped = 0;
  for (std::size_t t = 0; t < sign_.size(); ++t) flipped += area_as_at_rest(x, t) < 0.0;
  return flipped;
}

}  // namespace planar
