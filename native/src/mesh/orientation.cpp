// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/orientation.h"

#include <algorithm>
#include <limits>

namespace planar {

namespace {

/// Twice the signed area. Differences and products of float32 values are exact, or nearly so, in double.
double doubled_area(const Points& x, const int* corner) {
  const auto rounded = [&x](int i, int axis) { return static_cast<double>(static_cast<float>(x(i, axis))); };
  const double ax = rounded(corner[1], 0) - rounded(corner[0], 0);
  const double ay = rounded(corner[1], 1) - rounded(corner[0], 1);
  const double bx = rounded(corner[2], 0) - rounded(corner[0], 0);
  const double by = rounded(corner[2], 1) - rounded(corner[0], 1);
  return ax * by - ay * bx;
}

}  // namespace

Orientation::Orientation(const Points& rest, const Triangles& triangles)
    : triangles_(triangles), sign_(static_cast<std::size_t>(triangles.rows())) {
  for (std::size_t t = 0; t < sign_.size(); ++t) {
    const int* corner = triangles_.data() + 3 * t;
    const double area = doubled_area(rest, corner);
    double coordinate = 0.0, side = 0.0;
    for (int c = 0; c < 3; ++c) {
      coordinate = std::max(coordinate, rest.row(corner[c]).cwiseAbs().maxCoeff());
      side = std::max(side, (rest.row(corner[c]) - rest.row(corner[(c + 1) % 3])).norm());
    }
    const double rounding = 4.0 * std::numeric_limits<float>::epsilon() * coordinate * side;
    sign_[t] = static_cast<double>((area > rounding) - (area < -rounding));
  }
}

void Orientation::measure(const Points& x, std::vector<double>& area) const {
  area.resize(sign_.size());
  for (std::size_t t = 0; t < sign_.size(); ++t) {
    area[t] = sign_[t] == 0.0 ? 1.0 : sign_[t] * doubled_area(x, triangles_.data() + 3 * t);
  }
}

Flags Orientation::flipped(const Points& x) const {
  Flags result(triangles_.rows());
  for (std::size_t t = 0; t < sign_.size(); ++t)
    result[static_cast<Eigen::Index>(t)] = sign_[t] * doubled_area(x, triangles_.data() + 3 * t) < 0.0;
  return result;
}

int Orientation::count_flipped(const Points& x) const {
  int flipped = 0;
  for (std::size_t t = 0; t < sign_.size(); ++t)
    flipped += sign_[t] * doubled_area(x, triangles_.data() + 3 * t) < 0.0;
  return flipped;
}

}  // namespace planar
