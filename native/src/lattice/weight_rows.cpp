// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/weight_rows.h"

#include <algorithm>
#include <map>

#include "base/index.h"

namespace planar {

template <int D>
void product(const LatticeWeights& weights, const Rows<D>& d, Rows<D>& u) {
  u.resize(weights.rows(), D);
  const int* start = weights.outerIndexPtr();
  const int* column = weights.innerIndexPtr();
  const double* value = weights.valuePtr();
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    std::array<double, D> sum{};
    for (int e = start[i]; e < start[i + 1]; ++e) {
      const double* p = d.data() + static_cast<std::ptrdiff_t>(D) * column[e];
      for (int k = 0; k < D; ++k) sum[at(k)] += value[e] * p[k];
    }
    for (int k = 0; k < D; ++k) u(i, k) = sum[at(k)];
  }
}

template <int D>
void add_transposed(const LatticeWeights& weights, const Rows<D>& g, Rows<D>& r) {
  const int* start = weights.outerIndexPtr();
  const int* column = weights.innerIndexPtr();
  const double* value = weights.valuePtr();
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    const double* force = g.data() + D * i;
    if (std::all_of(force, force + D, [](double f) { return f == 0.0; })) continue;
    for (int e = start[i]; e < start[i + 1]; ++e) {
      double* p = r.data() + static_cast<std::ptrdiff_t>(D) * column[e];
      for (int k = 0; k < D; ++k) p[k] += value[e] * force[k];
    }
  }
}

template void product<2>(const LatticeWeights&, const Rows<2>&, Rows<2>&);
template void product<3>(const LatticeWeights&, const Rows<3>&, Rows<3>&);
template void add_transposed<2>(const LatticeWeights&, const Rows<2>&, Rows<2>&);
template void add_transposed<3>(const LatticeWeights&, const Rows<3>&, Rows<3>&);

LatticeWeights of_rows(Eigen::Index columns, const std::vector<int>& start, const std::vector<int>& column,
                       const std::vector<double>& value) {
  LatticeWeights result(static_cast<Eigen::Index>(start.size()) - 1, columns);
  result.resizeNonZeros(static_cast<Eigen::Index>(column.size()));
  std::copy(start.begin(), start.end(), result.outerIndexPtr());
  std::copy(column.begin(), column.end(), result.innerIndexPtr());
  std::copy(value.begin(), value.end(), result.valuePtr());
  return result;
}

LatticeWeights chosen_rows(const LatticeWeights& weights, const std::vector<int>& chosen) {
  const int* start = weights.outerIndexPtr();
  LatticeWeights result(static_cast<Eigen::Index>(chosen.size()), weights.cols());
  Eigen::Index entries = 0;
  for (const int row : chosen) entries += start[row + 1] - start[row];
  result.resizeNonZeros(entries);
  int end = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const int from = start[chosen[i]], to = start[chosen[i] + 1];
    result.outerIndexPtr()[i] = end;
    std::copy(weights.innerIndexPtr() + from, weights.innerIndexPtr() + to, result.innerIndexPtr() + end);
    std::copy(weights.valuePtr() + from, weights.valuePtr() + to, result.valuePtr() + end);
    end += to - from;
  }
  result.outerIndexPtr()[chosen.size()] = end;
  return result;
}

Supports supports_of(const LatticeWeights& weights) {
  Supports result;
  std::map<std::vector<int>, int> known;
  const int* start = weights.outerIndexPtr();
  const int* column = weights.innerIndexPtr();
  std::vector<int> points;
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    points.assign(column + start[i], column + start[i + 1]);
    if (i > 0 && points == result.points[at(result.kind.back())]) {
      result.kind.push_back(result.kind.back());
      continue;
    }
    const auto [found, added] = known.try_emplace(points, static_cast<int>(result.points.size()));
    if (added) result.points.push_back(points);
    result.kind.push_back(found->second);
  }
  return result;
}

namespace {

constexpr std::size_t most_couplings = 50'000'000;  // what a matrix of a few gigabytes has

void keep_each_once(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

std::vector<std::array<int, 2>> couplings(const LatticeWeights& weights,
                                          const std::vector<std::array<int, 2>>& edges) {
  const Supports supports = supports_of(weights);
  const std::size_t n_kinds = supports.points.size();
  std::vector<std::vector<int>> neighbours(n_kinds);  // kinds
  for (std::size_t kind = 0; kind < n_kinds; ++kind) neighbours[kind].push_back(static_cast<int>(kind));
  for (const auto& [i, j] : edges) {
    const int a = supports.kind[at(i)], b = supports.kind[at(j)];
    if (a == b || neighbours[at(a)].back() == b) continue;
    neighbours[at(a)].push_back(b);
    neighbours[at(b)].push_back(a);
  }
  std::vector<std::vector<int>> kinds_of_point(at(weights.cols()));
  std::vector<std::vector<int>> reached(n_kinds);  // points of a kind and its neighbours
  for (std::size_t kind = 0; kind < n_kinds; ++kind) {
    keep_each_once(neighbours[kind]);
    for (const int other : neighbours[kind]) {
      const std::vector<int>& points = supports.points[at(other)];
      reached[kind].insert(reached[kind].end(), points.begin(), points.end());
    }
    keep_each_once(reached[kind]);
    for (const int point : supports.points[kind]) kinds_of_point[at(point)].push_back(static_cast<int>(kind));
  }
  std::vector<std::array<int, 2>> result;
  std::vector<int> marked(at(weights.cols()), -1);
  for (int p = 0; p < static_cast<int>(weights.cols()); ++p) {
    for (const int kind : kinds_of_point[at(p)]) {
      for (const int other : reached[at(kind)]) {
        if (other <= p || marked[at(other)] == p) continue;
        marked[at(other)] = p;
        result.push_back({p, other});
        if (result.size() > most_couplings)
          throw SolveError("the lattice has too many points for this basis");
      }
    }
  }
  return result;
}

void RowSum::clear(int width) {
  for (const int point : point_) place_[at(point)] = -1;
  point_.clear();
  value_.clear();
  width_ = width;
}

}  // namespace planar
