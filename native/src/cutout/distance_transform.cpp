// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/distance_transform.h"

#include <cmath>
#include <limits>

namespace planar {
namespace {

/// More than any distance of the reach, and half of what would overflow when one is added.
constexpr std::int32_t far_away = std::numeric_limits<std::int32_t>::max() / 2;

/// Rows from each sample to the nearest site of its column, positive upwards.
Grid<std::int32_t> rows_to_site(const Mask& sites) {
  const int w = sites.width(), h = sites.height();
  Grid<std::int32_t> up(w, h), result(w, h);
  for (int y = h - 1; y >= 0; --y) {
    const std::uint8_t* here = sites.row(y);
    const std::int32_t* above = y + 1 < h ? up.row(y + 1) : nullptr;
    std::int32_t* out = up.row(y);
    for (int x = 0; x < w; ++x) {
      const std::int32_t next = above != nullptr ? std::min(above[x] + 1, far_away) : far_away;
      out[x] = here[x] != 0 ? 0 : next;
    }
  }
  std::vector<std::int32_t> down(at(w), far_away);
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* here = sites.row(y);
    const std::int32_t* above = up.row(y);
    std::int32_t* out = result.row(y);
    for (int x = 0; x < w; ++x) {
      const std::int32_t below = here[x] != 0 ? 0 : std::min(down[at(x)] + 1, far_away);
      down[at(x)] = below;
      out[x] = below < above[x] ? -below : above[x];
    }
  }
  return result;
}

/// The parabolas of a row's columns whose lower envelope the distances are.
class Envelope {
 public:
  explicit Envelope(int width) : column_(at(width)), square_(at(width)), from_(at(width) + 1) {}

  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }

  /// Columns come in ascending order.
  void add(int column, double square) {
    double start = -std::numeric_limits<double>::infinity();
    while (count_ > 0) {
      const std::size_t last = count_ - 1;
      const double p = column_[last], q = column;
      start = ((square + q * q) - (square_[last] + p * p)) / (2.0 * (q - p));
      if (start > from_[last]) break;
      --count_;
    }
    if (count_ == 0) start = -std::numeric_limits<double>::infinity();
    column_[count_] = column;
    square_[count_] = square;
    from_[count_++] = start;
    from_[count_] = std::numeric_limits<double>::infinity();
    looked_ = 0;
  }

  /// Asked for in ascending order of x. The column, and the squared distance.
  int lowest(int x, double& square) {
    while (from_[looked_ + 1] < x) ++looked_;
    const double across = x - column_[looked_];
    square = across * across + square_[looked_];
    return column_[looked_];
  }

 private:
  std::vector<int> column_;
  std::vector<double> square_, from_;  ///< from which x a parabola is the lowest
  std::size_t count_ = 0, looked_ = 0;
};

Grid<float> distances(const Mask& sites, double reach, Grid<std::int32_t>* nearest) {
  const int w = sites.width(), h = sites.height();
  const Grid<std::int32_t> rows = rows_to_site(sites);
  Grid<float> result(w, h, static_cast<float>(reach));
  Envelope envelope(w);
  for (int y = 0; y < h; ++y) {
    const std::int32_t* row = rows.row(y);
    envelope.clear();
    for (int x = 0; x < w; ++x) {
      if (std::abs(row[x]) > reach) continue;
      // Of sites side by side only the outermost are nearest to anything but themselves.
      if (row[x] == 0 && x > 0 && x + 1 < w && row[x - 1] == 0 && row[x + 1] == 0) continue;
      envelope.add(x, static_cast<double>(row[x]) * row[x]);
    }
    if (envelope.empty()) continue;
    for (int x = 0; x < w; ++x) {
      double square = 0.0;
      const int column = row[x] == 0 ? x : envelope.lowest(x, square);
      if (square >= reach * reach) continue;
      result(x, y) = static_cast<float>(std::sqrt(square));
      if (nearest != nullptr) {
        (*nearest)(x, y) = static_cast<std::int32_t>(rows.index(column, y + row[column]));
      }
    }
  }
  return result;
}

}  // namespace

NearestSites nearest_sites(const Mask& sites, double reach) {
  Grid<std::int32_t> site(sites.width(), sites.height(), -1);
  Grid<float> distance = distances(sites, reach, &site);
  return {std::move(distance), std::move(site)};
}

Grid<float> distance_to(const Mask& sites, double reach) { return distances(sites, reach, nullptr); }

}  // namespace planar
