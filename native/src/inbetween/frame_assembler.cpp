// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/frame_assembler.h"

#include <algorithm>

namespace planar {

using Complex = std::complex<double>;

FrameAssembler::FrameAssembler(const EdgeGraph& graph)
    : graph_(graph), matrix_(graph.n_vertices, graph.n_vertices) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.vertex_count() + graph.edges.size());
  for (int v = 0; v < graph.n_vertices; ++v) entries.emplace_back(v, v, 1.0);
  for (const auto& [a, b] : graph.edges) entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  const auto find = [this](int row, int column) {
    const int* begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
    const int* end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - matrix_.innerIndexPtr());
  };
  for (const auto& [a, b] : graph.edges) entry_.push_back(find(std::max(a, b), std::min(a, b)));
  int parts_seen = 0;
  for (int v = 0; v < graph.n_vertices; ++v) {
    diagonal_.push_back(find(v, v));
    const int part = graph.part[static_cast<std::size_t>(v)];
    if (part == -1) pinned_.push_back(v);
    if (part == parts_seen) {
      pinned_.push_back(v);
      ++parts_seen;
    }
  }
  factor_.analyzePattern(matrix_);
  const auto& order = factor_.permutationP().indices();
  place_.assign(order.data(), order.data() + order.size());
  if (place_.empty()) {
    for (int v = 0; v < graph.n_vertices; ++v) place_.push_back(v);
  }
}

void FrameAssembler::factorize(const Eigen::VectorXd& weights) {
  weights_ = weights;
  double* value = matrix_.valuePtr();
  std::fill_n(value, matrix_.nonZeros(), 0.0);
  for (std::size_t i = 0; i < entry_.size(); ++i) {
    const double w = weights[static_cast<Eigen::Index>(i)];
    value[entry_[i]] -= w;
    for (const int v : graph_.edges[i]) value[diagonal_[static_cast<std::size_t>(v)]] += w;
  }
  // The right side of a part adds up to 0, so whatever holds one of its vertices holds it at 0 exactly.
  const double hold = weights.mean();
  for (const int v : pinned_) value[diagonal_[static_cast<std::size_t>(v)]] += hold;
  factor_.factorize(matrix_);
  if (factor_.info() != Eigen::Success || !(factor_.vectorD().minCoeff() > 0.0)) {
    throw SolveError("the frames cannot be assembled: the system of the edges is singular");
  }
  inverse_diagonal_ = factor_.vectorD().cwiseInverse();
}

template <Eigen::Index width>
void FrameAssembler::solve(const ComplexRows& edges, Eigen::Index first, ComplexRows& points) const {
  using Row = Eigen::Array<double, 1, 2 * width>;
  std::vector<Row, Eigen::aligned_allocator<Row>> x(graph_.vertex_count(), Row::Zero());
  for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
    const auto [a, b] = graph_.edges[i];
    const auto row = static_cast<Eigen::Index>(i);
    const auto* e = reinterpret_cast<const double*>(&edges(row, first));
    const Row pull = weights_[row] * Eigen::Map<const Row>(e);
    x[static_cast<std::size_t>(place_[static_cast<std::size_t>(a)])] -= pull;
    x[static_cast<std::size_t>(place_[static_cast<std::size_t>(b)])] += pull;
  }
  const auto& lower = factor_.matrixL().nestedExpression();
  const int* start = lower.outerIndexPtr();
  const int* row = lower.innerIndexPtr();
  const double* value = lower.valuePtr();
  for (std::size_t j = 0; j < x.size(); ++j) {
    const Row known = x[j];
    for (int k = start[j]; k < start[j + 1]; ++k) x[static_cast<std::size_t>(row[k])] -= value[k] * known;
  }
  for (std::size_t j = x.size(); j-- > 0;) {
    Row sum = inverse_diagonal_[static_cast<Eigen::Index>(j)] * x[j];
    for (int k = start[j]; k < start[j + 1]; ++k) sum -= value[k] * x[static_cast<std::size_t>(row[k])];
    x[j] = sum;
  }
  for (std::size_t v = 0; v < x.size(); ++v) {
    auto* p = reinterpret_cast<double*>(&points(static_cast<Eigen::Index>(v), first));
    Eigen::Map<Row>{p} = x[static_cast<std::size_t>(place_[v])];
  }
}

void FrameAssembler::assemble(const ComplexRows& edges, Eigen::Index first, ComplexRows& points) const {
  solve<lanes>(edges, first, points);
}

void FrameAssembler::assemble_one(const ComplexRows& edges, ComplexRows& points) const {
  solve<1>(edges, 0, points);
}

}  // namespace planar
