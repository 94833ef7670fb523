// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/boundary.h"

#include <cmath>

namespace planar {
namespace {

constexpr int least_points = 6;
/// Sizes are shortened by so much where a line leaves the band, so often; what is left is halved.
constexpr double shortening = 0.75;
constexpr int polygon_rounds = 8;

Eigen::RowVector2d on_ring(const Points& ring, double place) {
  const auto i = static_cast<Eigen::Index>(place);
  const double share = place - static_cast<double>(i);
  const Eigen::Index n = ring.rows();
  return (1.0 - share) * ring.row(i % n) + share * ring.row((i + 1) % n);
}

/// Places on the ring, in its points, so that ∫ ds/size is the same between each two.
std::vector<double> even_places(const std::vector<double>& size) {
  const std::size_t n = size.size();
  std::vector<double> sum(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    sum[i + 1] = sum[i] + 0.5 * ring_step * (1.0 / size[i] + 1.0 / size[(i + 1) % n]);
  }
  const auto count = static_cast<std::size_t>(std::max<double>(least_points, std::ceil(sum[n] - 1e-9)));
  std::vector<double> places(count);
  std::size_t from = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = sum[n] * static_cast<double>(k) / static_cast<double>(count);
    while (from + 1 < n && sum[from + 1] <= wanted) ++from;
    places[k] = static_cast<double>(from) + std::min(1.0, (wanted - sum[from]) / (sum[from + 1] - sum[from]));
  }
  return places;
}

}  // namespace

Points boundary_polygon(const Points& ring, const Grid<float>& distance, const Grid<float>& size,
                        const Band& band) {
  const auto n = static_cast<int>(ring.rows());
  std::vector<double> sizes;
  sizes.reserve(at(n));
  for (int i = 0; i < n; ++i) sizes.push_back(std::max(ring_step, sample(size, ring(i, 0), ring(i, 1))));
  const auto holds = [&](double from, double to) {
    return band.holds(distance, on_ring(ring, from), on_ring(ring, to));
  };

  std::vector<double> places;
  for (int round = 0; round < polygon_rounds; ++round) {
    places = even_places(sizes);
    bool all = true;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double from = places[k], to = k + 1 < places.size() ? places[k + 1] : places[0] + n;
      if (holds(from, to)) continue;
      all = false;
      for (int i = static_cast<int>(from) - 2; i <= static_cast<int>(to) + 3; ++i) {
        double& s = sizes[at((i % n + n) % n)];
        s = std::max(ring_step, shortening * s);
      }
    }
    if (all) break;
  }

  std::vector<double> kept;
  for (std::size_t k = 0; k < places.size(); ++k) {
    std::vector<double> ends{k + 1 < places.size() ? places[k + 1] : places[0] + n};
    double from = places[k];
    while (!ends.empty()) {
      const double to = ends.back();
      if (to - from > 1.0 && !holds(from, to)) {
        ends.push_back(0.5 * (from + to));
        continue;
      }
      kept.push_back(from);
      from = to;
      ends.pop_back();
    }
  }
  Points polygon(static_cast<Eigen::Index>(kept.size()), 2);
  for (std::size_t k = 0; k < kept.size(); ++k)
    polygon.row(static_cast<Eigen::Index>(k)) = on_ring(ring, kept[k]);
  return polygon;
}

}  // namespace planar
