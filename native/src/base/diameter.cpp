// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/diameter.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace planar {

namespace {

using Point = std::pair<double, double>;

double cross(const Point& from, const Point& a, const Point& b) {
  return (a.first - from.first) * (b.second - from.second) -
         (a.second - from.second) * (b.first - from.first);
}

/// The convex hull counter-clockwise, without points on its sides (Andrew's monotone chain).
std::vector<Point> hull_of(const Points& points) {
  std::vector<Point> sorted;
  for (Eigen::Index i = 0; i < points.rows(); ++i) sorted.emplace_back(points(i, 0), points(i, 1));
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;
  std::vector<Point> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const Point& point : sorted) {
      while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), point) <= 0.0)
        hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(sorted.begin(), sorted.end());
  }
  return hull;
}

}  // namespace

double diameter(const Points& points) {
  const std::vector<Point> hull = hull_of(points);
  const std::size_t n = hull.size();
  double longest = 0.0;
  const auto look = [&](std::size_t i, std::size_t j) {
    longest = std::max(longest, std::hypot(hull[i].first - hull[j].first, hull[i].second - hull[j].second));
  };
  // Rotating calipers: the corner furthest from a side moves on as the side does.
  std::size_t far = n > 2 ? 2 : n - 1;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    while (n > 2 && cross(hull[i], hull[next], hull[(far + 1) % n]) > cross(hull[i], hull[next], hull[far])) {
      look(i, far);
      far = (far + 1) % n;
    }
    look(i, far);
    look(next, far);
  }
  return longest;
}

}  // namespace planar
