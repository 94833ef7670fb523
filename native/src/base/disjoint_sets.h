// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/index.h"

namespace planar {

/// Disjoint sets over 0..n-1 whose representative is the smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) {
    while (parent_[at(i)] != i) {
      int& parent = parent_[at(i)];
      parent = parent_[at(parent)];
      i = parent;
    }
    return i;
  }
  /// Returns whether the two were apart.
  bool join(int a, int b) {
    a = find(a);
    b = find(b);
    parent_[at(std::max(a, b))] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace planar
