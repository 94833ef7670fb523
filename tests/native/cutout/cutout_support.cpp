// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/cutout_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "cutout/contour.h"

namespace planar::testing {

AlphaImage drawn(int width, int height, const std::function<bool(double, double)>& inside) {
  AlphaImage alpha(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) alpha(y, x) = inside(x + 0.5, y + 0.5) ? 1.0f : 0.0f;
  }
  return alpha;
}

AlphaImage random_art(unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const int width = static_cast<int>(number(1, 70)), height = static_cast<int>(number(1, 70));
  struct Stroke {
    double x0, y0, x1, y1, radius;
    bool cleared;
  };
  std::vector<Stroke> strokes(static_cast<std::size_t>(number(1, 7)));
  const bool long_ones = number(0, 1) < 0.5;
  for (Stroke& s : strokes) {
    s = {number(0, width),
         number(0, height),
         0,
         0,
         number(0.6, long_ones ? 4.0 : 14.0),
         &s != strokes.data() && number(0, 1) < 0.3};
    s.x1 = long_ones ? number(0, width) : s.x0;
    s.y1 = long_ones ? number(0, height) : s.y0;
  }
  const double block = std::floor(number(1, 6)), dots = number(0, 1) < 0.2 ? number(0, 0.1) : 0.0;
  AlphaImage alpha = drawn(width, height, [&](double x, double y) {
    x = std::floor(x / block) * block + 0.5 * block;  // pixel art
    y = std::floor(y / block) * block + 0.5 * block;
    bool in = false;
    for (const Stroke& s : strokes) {
      const double dx = s.x1 - s.x0, dy = s.y1 - s.y0, length = dx * dx + dy * dy;
      const double t =
          length > 0.0 ? std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / length, 0.0, 1.0) : 0.0;
      if (std::hypot(x - s.x0 - t * dx, y - s.y0 - t * dy) <= s.radius) in = !s.cleared;
    }
    return in || (dots > 0.0 && number(0, 1) < dots);
  });
  alpha(height / 2, width / 2) = 1.0f;
  return alpha;
}

int lost_pixels(const AlphaImage& alpha, const std::vector<Points>& rings, double threshold) {
  const auto width = static_cast<int>(alpha.cols()), height = static_cast<int>(alpha.rows());
  std::vector<char> lost(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  constexpr std::array<std::array<double, 2>, 5> places{
      {{0.5, 0.5}, {0.001, 0.001}, {0.999, 0.001}, {0.001, 0.999}, {0.999, 0.999}}};
  for (const auto& [dx, dy] : places) {
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(height));
    for (const Points& ring : rings) {
      for (Eigen::Index i = 0; i < ring.rows(); ++i) {
        Eigen::RowVector2d a = ring.row(i), b = ring.row((i + 1) % ring.rows());
        if (a[1] > b[1]) std::swap(a, b);
        const int first = std::max(0, static_cast<int>(std::ceil(a[1] - dy)));
        for (int y = first; y < height && y + dy < b[1]; ++y) {
          crossings[static_cast<std::size_t>(y)].push_back(a[0] +
                                                           (y + dy - a[1]) * (b[0] - a[0]) / (b[1] - a[1]));
        }
      }
    }
    for (int y = 0; y < height; ++y) {
      auto& line = crossings[static_cast<std::size_t>(y)];
      std::sort(line.begin(), line.end());
      std::size_t passed = 0;
      for (int x = 0; x < width; ++x) {
        while (passed < line.size() && line[passed] < x + dx) ++passed;
        if (passed % 2 == 0 && static_cast<double>(alpha(y, x)) > threshold)
          lost[static_cast<std::size_t>(y * width + x)] = 1;
      }
    }
  }
  return static_cast<int>(std::count(lost.begin(), lost.end(), 1));
}

std::vector<Points> polygons(const Cutout& cutout) {
  std::vector<Points> result;
  for (const Eigen::VectorXi& ring : cutout.rings) {
    Points polygon(ring.size(), 2);
    for (Eigen::Index i = 0; i < ring.size(); ++i) polygon.row(i) = cutout.points.row(ring[i]);
    result.push_back(polygon);
  }
  return result;
}

double area_of(const std::vector<Points>& rings) {
  double area = 0.0;
  for (const Points& ring : rings) area += signed_area(ring);
  return area;
}

double smallest_angle(const Points& points, const Triangles& triangles) {
  double smallest = 180.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::RowVector2d a = points.row(triangles(t, (c + 1) % 3)) - points.row(triangles(t, c));
      const Eigen::RowVector2d b = points.row(triangles(t, (c + 2) % 3)) - points.row(triangles(t, c));
      smallest =
          std::min(smallest, std::atan2(a[0] * b[1] - a[1] * b[0], a.dot(b)) * 180.0 / 3.14159265358979);
    }
  }
  return smallest;
}

}  // namespace planar::testing
