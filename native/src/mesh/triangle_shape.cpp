// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/triangle_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/disjoint_sets.h"
#include "base/index.h"

namespace planar {

namespace {

constexpr double least_area = 1e-6;      // of the median
constexpr double least_altitude = 1e-3;  // of the median
constexpr double float32_epsilon = std::numeric_limits<float>::epsilon();

template <typename Positions>
double longest_side(const Positions& x, const int* corner) {
  double longest = 0.0;
  for (int c = 0; c < 3; ++c) {
    longest = std::max(longest, (x.row(corner[c]) - x.row(corner[(c + 1) % 3])).norm());
  }
  return longest;
}

/// Sides times coordinates times this is what rounding the corners may add to twice the area, at most.
template <typename Positions>
double rounding(const Positions& x, const int* corner) {
  double coordinate = 0.0;
  for (int c = 0; c < 3; ++c) coordinate = std::max(coordinate, x.row(corner[c]).cwiseAbs().maxCoeff());
  return 4.0 * float32_epsilon * coordinate * longest_side(x, corner);
}

/// The upper one of two middle values; 0 of none.
double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double doubled_area(const Points& x, const int* corner) {
  const double ax = x(corner[1], 0) - x(corner[0], 0), ay = x(corner[1], 1) - x(corner[0], 1);
  const double bx = x(corner[2], 0) - x(corner[0], 0), by = x(corner[2], 1) - x(corner[0], 1);
  return ax * by - ay * bx;
}

bool float32_tells(const Points& x, const int* corner) {
  return std::abs(doubled_area(x, corner)) > rounding(x, corner);
}

namespace {

double size_of_area(const Points& x, const int* corner) { return std::abs(doubled_area(x, corner)); }

double size_of_area(const SpacePoints& x, const int* corner) {
  const Eigen::RowVector3d a = x.row(corner[1]) - x.row(corner[0]), b = x.row(corner[2]) - x.row(corner[0]);
  return a.cross(b).norm();
}

template <typename Positions>
Flags flat_at(const Positions& rest, const Triangles& triangles) {
  struct Part {
    std::vector<double> areas, altitudes;  // of the triangles that are more than rounding errors; areas twice
    int told = 0;                          // of them
  };
  const auto corners = [&triangles](Eigen::Index t) { return triangles.data() + 3 * t; };
  DisjointSets connected(static_cast<std::size_t>(rest.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    connected.join(triangles(t, 0), triangles(t, 1));
    connected.join(triangles(t, 0), triangles(t, 2));
  }
  std::vector<int> number(static_cast<std::size_t>(rest.rows()), -1);
  std::vector<Part> parts;
  const auto part_of = [&](Eigen::Index t) -> Part& {
    int& part = number[at(connected.find(triangles(t, 0)))];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    return parts[at(part)];
  };
  Eigen::ArrayXd area(triangles.rows()), altitude(triangles.rows());
  Flags flat(triangles.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double longest = longest_side(rest, corners(t));
    area[t] = size_of_area(rest, corners(t));
    altitude[t] = longest > 0.0 ? area[t] / longest : 0.0;
    flat[t] = !(area[t] > rounding(rest, corners(t)));
    Part& part = part_of(t);
    if (!(altitude[t] > float32_epsilon * longest)) continue;
    part.areas.push_back(area[t]);
    part.altitudes.push_back(altitude[t]);
    part.told += !flat[t];
  }
  struct Limits {
    double area, altitude;
    bool told;  // float32 tells half of the part
  };
  std::vector<Limits> limits;
  limits.reserve(parts.size());
  for (Part& part : parts) {
    const bool told = 2 * part.told >= static_cast<int>(part.areas.size());
    limits.push_back({least_area * median(part.areas), least_altitude * median(part.altitudes), told});
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Limits& limit = limits[at(number[at(connected.find(triangles(t, 0)))])];
    flat[t] = (flat[t] && limit.told) || !(area[t] > limit.area) || !(altitude[t] > limit.altitude);
  }
  return flat;
}

}  // namespace

Flags flat_triangles(const Points& rest, const Triangles& triangles) { return flat_at(rest, triangles); }

Flags flat_triangles(const SpacePoints& rest, const Triangles& triangles) { return flat_at(rest, triangles); }

}  // namespace planar
