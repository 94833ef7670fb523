// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/orientation.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "mesh/triangle_shape.h"

namespace planar {

namespace {

/// Twice the signed area. Differences and products of float32 values are exact, or nearly so, in double.
double doubled_area_in_float32(const Points& x, const Eigen::RowVector2d& origin, const int* corner) {
  const auto rounded = [&](int i, int axis) {
    return static_cast<double>(static_cast<float>(x(corner[i], axis) + origin[axis]));
  };
  const double ax = rounded(1, 0) - rounded(0, 0), ay = rounded(1, 1) - rounded(0, 1);
  const double bx = rounded(2, 0) - rounded(0, 0), by = rounded(2, 1) - rounded(0, 1);
  return ax * by - ay * bx;
}

}  // namespace

Orientation::Orientation(const Points& rest, const Triangles& triangles, Flags flat,
                         const Eigen::RowVector2d& origin)
    : triangles_(triangles),
      flat_(std::move(flat)),
      origin_(origin),
      sign_(static_cast<std::size_t>(triangles.rows())) {
  for (std::size_t t = 0; t < sign_.size(); ++t) {
    const int* corner = triangles_.data() + 3 * t;
    if (flat_[static_cast<Eigen::Index>(t)] || !float32_tells(rest, corner)) continue;
    sign_[t] = doubled_area_in_float32(rest, Eigen::RowVector2d::Zero(), corner) > 0.0 ? 1.0 : -1.0;
  }
}

Orientation::Orientation(const Triangles& triangles, Flags flat)
    : triangles_(triangles), flat_(std::move(flat)), origin_(Eigen::RowVector2d::Zero()) {
  for (const bool unseen : flat_) sign_.push_back(unseen ? 0.0 : 1.0);
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
  for (std::size_t t = 0; t < sign_.size(); ++t)
    area[t] = sign_[t] == 0.0 ? 1.0 : sign_[t] * doubled_area(x, triangles_.data() + 3 * t);
}

Flags Orientation::flipped(const Points& x) const {
  Flags result(triangles_.rows());
  for (std::size_t t = 0; t < sign_.size(); ++t)
    result[static_cast<Eigen::Index>(t)] = area_as_at_rest(x, t) < 0.0;
  return result;
}

std::vector<int> Orientation::flipped_of(const std::vector<int>& rows, const Points& x) const {
  std::vector<int> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result),
               [&](int t) { return area_as_at_rest(x, static_cast<std::size_t>(t)) < 0.0; });
  return result;
}

int Orientation::count_flipped(const Points& x) const {
  int flipped = 0;
  for (std::size_t t = 0; t < sign_.size(); ++t) flipped += area_as_at_rest(x, t) < 0.0;
  return flipped;
}

}  // namespace planar
