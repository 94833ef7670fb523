// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/frame_assembler.h"

#include <algorithm>

#include "base/index.h"

namespace planar {

namespace {

/// `width` frames of a vertex or an edge as the real numbers that they are in memory.
template <Eigen::Index width>
using Row = Eigen::Array<double, 1, 2 * width>;

template <Eigen::Index width>
Eigen::Map<const Row<width>> row_of(const ComplexRows& table, Eigen::Index row, Eigen::Index first) {
  return Eigen::Map<const Row<width>>(reinterpret_cast<const double*>(&table(row, first)));
}

template <Eigen::Index width>
Eigen::Map<Row<width>> row_of(ComplexRows& table, Eigen::Index row, Eigen::Index first) {
  return Eigen::Map<Row<width>>(reinterpret_cast<double*>(&table(row, first)));
}

}  // namespace

FrameAssembler::FrameAssembler(const EdgeGraph& graph)
    : graph_(graph), solver_(SparseSolver::create(default_backend())), slot_(graph.vertex_count()) {
  const std::vector<int> order = solver_->fill_reducing_order(graph_pattern(graph.n_vertices, graph.edges));
  for (int k = 0; k < graph.n_vertices; ++k) slot_[at(order[at(k)])] = k;
  std::vector<std::array<int, 2>> edges;
  for (const auto& [a, b] : graph.edges) {
    const auto [earlier, later] = std::minmax({slot_[at(a)], slot_[at(b)]});
    edges.push_back({earlier, later});
  }
  matrix_ = graph_pattern(graph.n_vertices, edges);
  matrix_.value.resize(matrix_.row.size());
  for (const auto& [earlier, later] : edges) entry_.push_back(matrix_.find(later, earlier));
  int parts_seen = 0;
  for (int v = 0; v < graph.n_vertices; ++v) {
    diagonal_.push_back(matrix_.find(slot_[at(v)], slot_[at(v)]));
    const int part = graph.part[at(v)];
    if (part == -1) pinned_.push_back(v);
    if (part == parts_seen) {
      pinned_.push_back(v);
      ++parts_seen;
    }
  }
  solver_->analyze(matrix_);
}

void FrameAssembler::factorize(const Eigen::VectorXd& weights) {
  weights_ = weights;
  std::vector<double>& value = matrix_.value;
  std::fill(value.begin(), value.end(), 0.0);
  for (std::size_t i = 0; i < entry_.size(); ++i) {
    const double w = weights[static_cast<Eigen::Index>(i)];
    value[at(entry_[i])] -= w;
    for (const int v : graph_.edges[i]) value[at(diagonal_[at(v)])] += w;
  }
  // The right side of a part adds up to 0, so whatever holds one of its vertices holds it at 0 exactly.
  const double hold = weights.mean();
  for (const int v : pinned_) value[at(diagonal_[at(v)])] += hold;
  try {
    solver_->factorize(matrix_);
  } catch (const SolveError&) {
    throw SolveError("the frames cannot be assembled: the system of the edges is singular");
  }
}

template <Eigen::Index width>
void FrameAssembler::solve(const ComplexRows& edges, Eigen::Index first, ComplexRows& points) const {
  RightSides x = RightSides::Zero(graph_.n_vertices, 2 * width);
  for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
    const auto [a, b] = graph_.edges[i];
    const auto row = static_cast<Eigen::Index>(i);
    const Row<width> pull = weights_[row] * row_of<width>(edges, row, first);
    Eigen::Map<Row<width>>(&x(slot_[at(a)], 0)) -= pull;
    Eigen::Map<Row<width>>(&x(slot_[at(b)], 0)) += pull;
  }
  solver_->solve(x);
  place_points<width>(x, first, points);
}

template <Eigen::Index width>
void FrameAssembler::place_points(const RightSides& x, Eigen::Index first, ComplexRows& points) const {
  for (int v = 0; v < graph_.n_vertices; ++v) {
    row_of<width>(points, v, first) = Eigen::Map<const Row<width>>(&x(slot_[at(v)], 0));
  }
}

void FrameAssembler::assemble(const ComplexRows& edges, Eigen::Index first, ComplexRows& points) const {
  solve<lanes>(edges, first, points);
}

void FrameAssembler::assemble_one(const ComplexRows& edges, ComplexRows& points) const {
  solve<1>(edges, 0, points);
}

void FrameAssembler::assemble_sums(Eigen::Index first, ComplexRows& points) const {
  RightSides x(graph_.n_vertices, 2 * lanes);
  for (int v = 0; v < graph_.n_vertices; ++v) {
    Eigen::Map<Row<lanes>>(&x(slot_[at(v)], 0)) = row_of<lanes>(points, v, first);
  }
  solver_->solve(x);
  place_points<lanes>(x, first, points);
}

}  // namespace planar
