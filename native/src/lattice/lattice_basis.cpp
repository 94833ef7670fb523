// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/checks.h"
#include "base/index.h"
#include "lattice/weight_rows.h"
#include "planar/lattice.h"

namespace planar {

namespace {

constexpr int most_points = 64;  // an axis; Blender's limit

/// The weights along one axis: of the points from..to, which exist.
struct AxisWeights {
  int from = 0, to = 0;
  std::array<double, most_points> weight{};

  void add(int point, int last, double value) { weight[at(std::clamp(point, 0, last))] += value; }
};

/// Blender's key_curve_position_weights(): of the points before the segment, at its ends, and behind it.
std::array<double, 4> segment_weights(LatticeBasis basis, double t) {
  const double t2 = t * t, t3 = t2 * t;
  if (basis == LatticeBasis::linear) return {0.0, 1.0 - t, t, 0.0};
  if (basis == LatticeBasis::bspline) {
    return {-t3 / 6.0 + t2 / 2.0 - t / 2.0 + 1.0 / 6.0, t3 / 2.0 - t2 + 2.0 / 3.0,
            -t3 / 2.0 + t2 / 2.0 + t / 2.0 + 1.0 / 6.0, t3 / 6.0};
  }
  const double c = basis == LatticeBasis::cardinal ? 0.71 : 0.5;
  return {-c * t3 + 2.0 * c * t2 - c * t, (2.0 - c) * t3 + (c - 3.0) * t2 + 1.0,
          (c - 2.0) * t3 + (3.0 - 2.0 * c) * t2 + c * t, c * t3 - c * t2};
}

/// \param s place in units of the spacing
AxisWeights axis_weights(LatticeBasis basis, int count, double s) {
  AxisWeights result;
  const int last = count - 1;
  if (last == 0) {
    result.weight[0] = 1.0;
    return result;
  }
  if (basis == LatticeBasis::bernstein) {
    const double t = std::clamp(s / last, 0.0, 1.0);
    result.weight[0] = 1.0;
    for (int degree = 1; degree <= last; ++degree) {
      for (int k = degree; k > 0; --k) {
        result.weight[at(k)] = (1.0 - t) * result.weight[at(k)] + t * result.weight[at(k - 1)];
      }
      result.weight[0] *= 1.0 - t;
    }
    result.to = last;
    return result;
  }
  // So far out all four points are one.
  s = std::clamp(s, -3.0, count + 2.0);
  const int k = static_cast<int>(std::floor(s));
  const std::array<double, 4> weights = segment_weights(basis, s - k);
  for (int i = 0; i < 4; ++i) result.add(k - 1 + i, last, weights[at(i)]);
  result.from = std::clamp(k - 1, 0, last);
  result.to = std::clamp(k + 2, 0, last);
  return result;
}

void require_grid(const LatticeGrid& grid, Eigen::Index axes) {
  const auto n = static_cast<Eigen::Index>(grid.count.size());
  if (n != 2 && n != 3) {
    throw std::invalid_argument("counts has " + std::to_string(n) + " axes, expected 2 or 3");
  }
  if (axes != n) {
    throw std::invalid_argument("points has " + std::to_string(axes) + " columns, expected " +
                                std::to_string(n) + " (one per axis)");
  }
  require_rows("kinds", static_cast<Eigen::Index>(grid.basis.size()), n, "axis");
  require_rows("origin", grid.origin.size(), n, "axis");
  require_rows("spacing", grid.spacing.size(), n, "axis");
  for (Eigen::Index a = 0; a < n; ++a) {
    const int count = grid.count[at(a)];
    if (count < 1 || count > most_points) {
      throw std::invalid_argument(row_of("counts", a) + std::to_string(count) + " is not from 1 to " +
                                  std::to_string(most_points));
    }
    if (!std::isfinite(grid.origin[a])) {
      throw std::invalid_argument(row_of("origin", a) + "not a finite number");
    }
    if (count > 1 && !(std::isfinite(grid.spacing[a]) && grid.spacing[a] > 0.0)) {
      throw std::invalid_argument(row_of("spacing", a) + "must be a finite number above 0");
    }
  }
}

}  // namespace

LatticeWeights lattice_weights(const Coordinates& places, const LatticeGrid& grid) {
  require_grid(grid, places.cols());
  require_finite_rows("points", places);
  const std::size_t n_axes = grid.count.size();
  const std::array<int, 3> count{grid.count[0], grid.count[1], n_axes == 3 ? grid.count[2] : 1};
  std::vector<int> start{0}, column;
  std::vector<double> value;
  start.reserve(at(places.rows()) + 1);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    std::array<AxisWeights, 3> axis;
    axis[2].weight[0] = 1.0;
    for (std::size_t a = 0; a < n_axes; ++a) {
      const auto column_of_axis = static_cast<Eigen::Index>(a);
      const double s = count[a] == 1 ? 0.0
                                     : (places(i, column_of_axis) - grid.origin[column_of_axis]) /
                                           grid.spacing[column_of_axis];
      axis[a] = axis_weights(grid.basis[a], count[a], s);
    }
    for (int w = axis[2].from; w <= axis[2].to; ++w) {
      for (int v = axis[1].from; v <= axis[1].to; ++v) {
        const double weight_vw = axis[2].weight[at(w)] * axis[1].weight[at(v)];
        for (int u = axis[0].from; u <= axis[0].to; ++u) {
          const double weight = weight_vw * axis[0].weight[at(u)];
          if (weight == 0.0) continue;
          column.push_back(u + count[0] * (v + count[1] * w));
          value.push_back(weight);
        }
      }
    }
    if (column.size() > at(std::numeric_limits<int>::max())) {
      throw std::invalid_argument("points: so many with so many weights are not supported");
    }
    start.push_back(static_cast<int>(column.size()));
  }
  return of_rows(count[0] * count[1] * count[2], start, column, value);
}

}  // namespace planar
