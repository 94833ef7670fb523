// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/contour.h"

#include <array>
#include <cmath>

namespace planar {
namespace {

/// Sides of a cell of four samples: below, right, above, left. A segment goes from the first to the second.
struct Segment {
  int from, to;
};

/// A crossing is never at a sample itself, where those of four sides would be one point.
constexpr double from_sample = 0.01;

/// By which corners are above zero: 1 for (x, y), 2 for (x+1, y), 4 for (x+1, y+1), 8 for (x, y+1). With two
/// of them across, 5 and 10, what is above zero is joined, and 16 more stand for its being apart.
constexpr int saddle = 16;

std::array<Segment, 2> segments(int corners) {
  constexpr Segment none{-1, -1};
  switch (corners) {
    case 1:
      return {{{0, 3}, none}};
    case 2:
      return {{{1, 0}, none}};
    case 3:
      return {{{1, 3}, none}};
    case 4:
      return {{{2, 1}, none}};
    case 5:
      return {{{0, 1}, {2, 3}}};
    case 5 + saddle:
      return {{{0, 3}, {2, 1}}};
    case 6:
      return {{{2, 0}, none}};
    case 7:
      return {{{2, 3}, none}};
    case 8:
      return {{{3, 2}, none}};
    case 9:
      return {{{0, 2}, none}};
    case 10:
      return {{{3, 0}, {1, 2}}};
    case 10 + saddle:
      return {{{1, 0}, {3, 2}}};
    case 11:
      return {{{1, 2}, none}};
    case 12:
      return {{{3, 1}, none}};
    case 13:
      return {{{0, 1}, none}};
    case 14:
      return {{{3, 0}, none}};
    default:
      return {{none, none}};
  }
}

std::array<Segment, 2> segments_of(const Grid<float>& values, int x, int y) {
  const float a = values(x, y), b = values(x + 1, y), c = values(x + 1, y + 1), d = values(x, y + 1);
  int corners = (a > 0.0f ? 1 : 0) + (b > 0.0f ? 2 : 0) + (c > 0.0f ? 4 : 0) + (d > 0.0f ? 8 : 0);
  if ((corners == 5 || corners == 10) && a + b + c + d <= 0.0f) corners += saddle;
  return segments(corners);
}

Eigen::RowVector2d crossing(const Grid<float>& values, int x, int y, int side) {
  const int x0 = x + (side == 1 ? 1 : 0), y0 = y + (side == 2 ? 1 : 0);
  const bool flat = side == 0 || side == 2;
  const double a = static_cast<double>(values(x0, y0));
  const double b = static_cast<double>(values(x0 + (flat ? 1 : 0), y0 + (flat ? 0 : 1)));
  const double share = std::clamp(a / (a - b), from_sample, 1.0 - from_sample);
  return {x0 + (flat ? share : 0.0), y0 + (flat ? 0.0 : share)};
}

}  // namespace

std::vector<Points> zero_contours(const Grid<float>& values) {
  constexpr std::array<int, 4> step_x{0, 1, 0, -1}, step_y{-1, 0, 1, 0};
  std::vector<Points> rings;
  Mask passed(values.width(), values.height(), 0);  // bit `side` of a cell: the segment that comes in there
  std::vector<Eigen::RowVector2d> line;
  for (int y = 0; y + 1 < values.height(); ++y) {
    const float *low = values.row(y), *high = values.row(y + 1);
    for (int x = 0; x + 1 < values.width(); ++x) {
      const bool first = low[x] > 0.0f;
      if (first == (low[x + 1] > 0.0f) && first == (high[x] > 0.0f) && first == (high[x + 1] > 0.0f))
        continue;
      for (const Segment& start : segments_of(values, x, y)) {
        if (start.from < 0 || (passed(x, y) >> start.from & 1) != 0) continue;
        line.clear();
        int i = x, j = y, from = start.from;
        while ((passed(i, j) >> from & 1) == 0) {
          passed(i, j) = static_cast<std::uint8_t>(passed(i, j) | 1 << from);
          const auto both = segments_of(values, i, j);
          const int to = both[0].from == from ? both[0].to : both[1].to;
          line.push_back(crossing(values, i, j, to));
          i += step_x[at(to)];
          j += step_y[at(to)];
          from = (to + 2) % 4;
        }
        rings.push_back(rows_of(line));
      }
    }
  }
  return rings;
}

Points rows_of(const std::vector<Eigen::RowVector2d>& points) {
  Points rows(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t i = 0; i < points.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = points[i];
  return rows;
}

double perimeter(const Points& ring) {
  double length = 0.0;
  for (Eigen::Index i = 0; i < ring.rows(); ++i)
    length += (ring.row((i + 1) % ring.rows()) - ring.row(i)).norm();
  return length;
}

double signed_area(const Points& ring) {
  double doubled = 0.0;
  for (Eigen::Index i = 0; i < ring.rows(); ++i) {
    const Eigen::Index next = (i + 1) % ring.rows();
    doubled += ring(i, 0) * ring(next, 1) - ring(next, 0) * ring(i, 1);
  }
  return 0.5 * doubled;
}

Points even_ring(const Points& ring, double step) {
  const double length = perimeter(ring);
  const auto n = std::max<Eigen::Index>(12, std::lround(length / step));
  Points result(n, 2);
  Eigen::Index from = 0;
  double before = 0.0, side = (ring.row(1 % ring.rows()) - ring.row(0)).norm();
  for (Eigen::Index k = 0; k < n; ++k) {
    const double place = length * static_cast<double>(k) / static_cast<double>(n);
    while (before + side < place && from + 1 < ring.rows()) {
      before += side;
      ++from;
      side = (ring.row((from + 1) % ring.rows()) - ring.row(from)).norm();
    }
    const double share = side > 0.0 ? std::min((place - before) / side, 1.0) : 0.0;
    result.row(k) = (1.0 - share) * ring.row(from) + share * ring.row((from + 1) % ring.rows());
  }
  return result;
}

}  // namespace planar
