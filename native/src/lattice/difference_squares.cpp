// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/difference_squares.h"

#include <algorithm>

#include "base/index.h"

namespace planar {

namespace {

/// Adds a symmetric matrix over some points: `value` is its upper triangle, by rows.
void add_dense(const std::vector<int>& points, const std::vector<double>& value, PointMatrix& matrix) {
  const std::size_t n = points.size();
  std::vector<std::pair<int, std::size_t>> order;
  order.reserve(n);
  for (std::size_t i = 0; i < n; ++i) order.emplace_back(matrix.place(points[i]), i);
  std::sort(order.begin(), order.end());
  std::vector<int> place;
  place.reserve(n);
  for (const auto& entry : order) place.push_back(entry.first);
  std::vector<double> sorted;
  sorted.reserve(value.size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i; j < n; ++j) {
      const std::size_t a = std::min(order[i].second, order[j].second);
      const std::size_t b = std::max(order[i].second, order[j].second);
      sorted.push_back(value[a * n + b]);
    }
  }
  matrix.add(matrix.block(std::move(place)), sorted.data());
}

/// value += weight · row rowᵀ, the upper triangle.
void add_square(const std::vector<double>& row, double weight, std::vector<double>& value) {
  const std::size_t n = row.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double factor = weight * row[i];
    double* entries = value.data() + i * n;
    for (std::size_t j = i; j < n; ++j) entries[j] += factor * row[j];
  }
}

}  // namespace

void add_difference_squares(const LatticeWeights& weights, std::vector<WeightedPair> pairs,
                            PointMatrix& matrix) {
  std::sort(pairs.begin(), pairs.end(), [](const WeightedPair& a, const WeightedPair& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  const Supports supports = supports_of(weights);
  // Most pairs lie in one cell, where rows have the same points: their sum is gathered densely.
  std::vector<std::vector<double>> gathered(supports.points.size());
  std::vector<double> row, single;
  RowSum sum(weights);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const WeightedPair& pair = pairs[i];
    double weight = pair.weight;
    while (i + 1 < pairs.size() && pairs[i + 1].first == pair.first && pairs[i + 1].second == pair.second) {
      weight += pairs[++i].weight;
    }
    const int kind = supports.kind[at(pair.first)];
    if (kind == supports.kind[at(pair.second)]) {
      const std::size_t n = supports.points[at(kind)].size();
      const double* a = weights.valuePtr() + weights.outerIndexPtr()[pair.first];
      const double* b = weights.valuePtr() + weights.outerIndexPtr()[pair.second];
      row.resize(n);
      for (std::size_t k = 0; k < n; ++k) row[k] = a[k] - b[k];
      gathered[at(kind)].resize(n * n, 0.0);
      add_square(row, weight, gathered[at(kind)]);
      continue;
    }
    sum.clear(1);
    sum.add(pair.first, std::array{1.0});
    sum.add(pair.second, std::array{-1.0});
    row.resize(sum.points().size());
    for (int k = 0; k < sum.size(); ++k) row[at(k)] = sum.value(k, 0);
    single.assign(row.size() * row.size(), 0.0);
    add_square(row, weight, single);
    add_dense(sum.points(), single, matrix);
  }
  for (std::size_t kind = 0; kind < gathered.size(); ++kind) {
    if (!gathered[kind].empty()) add_dense(supports.points[kind], gathered[kind], matrix);
  }
}

}  // namespace planar
