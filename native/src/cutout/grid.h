// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/index.h"

namespace planar {

/// width×height samples, rows from the bottom. Sample (x, y) lies at the point (x, y).
template <typename Value>
class Grid {
 public:
  Grid() = default;
  Grid(int width, int height, Value value = {})
      : width_(width), height_(height), values_(at(width) * at(height), value) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return values_.size(); }
  std::size_t index(int x, int y) const { return at(y) * at(width_) + at(x); }

  Value& operator()(int x, int y) { return values_[index(x, y)]; }
  const Value& operator()(int x, int y) const { return values_[index(x, y)]; }
  Value* row(int y) { return values_.data() + index(0, y); }
  const Value* row(int y) const { return values_.data() + index(0, y); }
  std::vector<Value>& values() { return values_; }
  const std::vector<Value>& values() const { return values_; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<Value> values_;
};

/// A truth a sample.
using Mask = Grid<std::uint8_t>;

/// Bilinear between the samples; outside of them the nearest point of their rectangle. At least 2×2 samples.
inline double sample(const Grid<float>& grid, double x, double y) {
  x = std::clamp(x, 0.0, grid.width() - 1.0);
  y = std::clamp(y, 0.0, grid.height() - 1.0);
  const int i = std::min(static_cast<int>(x), grid.width() - 2);
  const int j = std::min(static_cast<int>(y), grid.height() - 2);
  const double a = x - i, b = y - j;
  const float *low = grid.row(j) + i, *high = low + grid.width();
  return (1.0 - b) * ((1.0 - a) * static_cast<double>(low[0]) + a * static_cast<double>(low[1])) +
         b * ((1.0 - a) * static_cast<double>(high[0]) + a * static_cast<double>(high[1]));
}

}  // namespace planar
