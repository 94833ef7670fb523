// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/regions.h"

#include "base/disjoint_sets.h"

namespace planar {
namespace {

/// Samples of one row side by side.
struct Run {
  int first, end, row;
};

}  // namespace

Regions regions_of(const Mask& mask) {
  const int w = mask.width(), h = mask.height();
  std::vector<Run> runs;
  std::vector<std::size_t> first_of_row;
  for (int y = 0; y < h; ++y) {
    first_of_row.push_back(runs.size());
    const std::uint8_t* row = mask.row(y);
    for (int x = 0; x < w; ++x) {
      if (row[x] == 0) continue;
      const int first = x;
      while (x < w && row[x] != 0) ++x;
      runs.push_back({first, x, y});
    }
  }
  first_of_row.push_back(runs.size());

  DisjointSets sets(runs.size());
  for (int y = 1; y < h; ++y) {
    std::size_t below = first_of_row[at(y - 1)];
    for (std::size_t i = first_of_row[at(y)]; i < first_of_row[at(y + 1)]; ++i) {
      while (below < first_of_row[at(y)] && runs[below].end <= runs[i].first) ++below;
      for (std::size_t j = below; j < first_of_row[at(y)] && runs[j].first < runs[i].end; ++j) {
        sets.join(static_cast<int>(i), static_cast<int>(j));
      }
    }
  }

  Regions result{Grid<std::int32_t>(w, h, -1), 0};
  std::vector<int> number(runs.size(), -1);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    int& n = number[at(sets.find(static_cast<int>(i)))];
    if (n < 0) n = result.count++;
    std::int32_t* row = result.region.row(runs[i].row);
    std::fill(row + runs[i].first, row + runs[i].end, n);
  }
  return result;
}

}  // namespace planar
