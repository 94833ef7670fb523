// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/sparse_solver.h"

#include <algorithm>
#include <stdexcept>

#include "base/index.h"
#include "linear/eigen_solver.h"
#ifdef PLANAR_CHOLMOD
#include "linear/cholmod_solver.h"
#endif

namespace planar {

int SparsityPattern::find(int i, int column) const {
  const auto first = row.begin() + column_start[at(column)], end = row.begin() + column_start[at(column) + 1];
  return static_cast<int>(std::lower_bound(first, end, i) - row.begin());
}

template <class Number>
Eigen::VectorX<Number> SelfAdjointMatrix<Number>::times(const Eigen::VectorX<Number>& x) const {
  Eigen::VectorX<Number> result = Eigen::VectorX<Number>::Zero(size);
  for (int j = 0; j < size; ++j) {
    int p = column_start[at(j)];
    Number sum = value[at(p)] * x[j];
    for (++p; p < column_start[at(j) + 1]; ++p) {
      sum += Eigen::numext::conj(value[at(p)]) * x[row[at(p)]];
      result[row[at(p)]] += value[at(p)] * x[j];
    }
    result[j] += sum;
  }
  return result;
}

template struct SelfAdjointMatrix<double>;
template struct SelfAdjointMatrix<std::complex<double>>;

SparsityPattern graph_pattern(int size, const std::vector<std::array<int, 2>>& edges) {
  std::vector<std::vector<int>> column(at(size));
  for (int i = 0; i < size; ++i) column[at(i)].push_back(i);
  for (const auto& [a, b] : edges) column[at(std::min(a, b))].push_back(std::max(a, b));
  SparsityPattern pattern;
  pattern.size = size;
  pattern.column_start.push_back(0);
  for (auto& rows : column) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    pattern.row.insert(pattern.row.end(), rows.begin(), rows.end());
    pattern.column_start.push_back(static_cast<int>(pattern.row.size()));
  }
  return pattern;
}

SparsityPattern doubled_pattern(const SparsityPattern& graph) {
  SparsityPattern pattern;
  pattern.size = 2 * graph.size;
  pattern.column_start.push_back(0);
  for (int j = 0; j < graph.size; ++j) {
    for (int axis = 0; axis < 2; ++axis) {
      for (int p = graph.column_start[at(j)]; p < graph.column_start[at(j) + 1]; ++p) {
        const int i = graph.row[at(p)];
        if (i > j || axis == 0) pattern.row.push_back(2 * i);
        pattern.row.push_back(2 * i + 1);
      }
      pattern.column_start.push_back(static_cast<int>(pattern.row.size()));
    }
  }
  return pattern;
}

#ifdef PLANAR_CHOLMOD

Backend default_backend() { return Backend::cholmod; }

std::unique_ptr<SparseSolver> SparseSolver::create(Backend backend) {
  return backend == Backend::cholmod ? make_cholmod_solver() : make_eigen_solver();
}

std::unique_ptr<HermitianSolver> HermitianSolver::create(Backend backend) {
  return backend == Backend::cholmod ? make_cholmod_hermitian_solver() : make_eigen_hermitian_solver();
}

#else

Backend default_backend() { return Backend::eigen; }

namespace {

void need_eigen(Backend backend) {
  if (backend == Backend::cholmod) throw std::invalid_argument("this build has no CHOLMOD");
}

}  // namespace

std::unique_ptr<SparseSolver> SparseSolver::create(Backend backend) {
  need_eigen(backend);
  return make_eigen_solver();
}

std::unique_ptr<HermitianSolver> HermitianSolver::create(Backend backend) {
  need_eigen(backend);
  return make_eigen_hermitian_solver();
}

#endif

}  // namespace planar
