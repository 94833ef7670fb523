// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/laplacian.h"

#include <utility>

#include "base/index.h"

namespace planar {

Laplacian::Laplacian(const std::vector<std::array<int, 2>>& edges, const Eigen::VectorXd& weight,
                     const std::vector<char>& free)
    : solver_(SparseSolver::create(default_backend())), unknowns_(*solver_, edges, free) {
  SymmetricMatrix matrix = unknowns_.zero<double>();
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const double w = weight[static_cast<Eigen::Index>(e)];
    const auto [first, second] = edges[e];
    for (const auto& [v, u] : {std::pair(first, second), std::pair(second, first)}) {
      const int i = unknowns_.slot[at(v)], j = unknowns_.slot[at(u)];
      if (i < 0) continue;
      matrix.value[at(matrix.find(i, i))] += w;
      if (j < 0) neighbours_.push_back({i, u, w});
      if (j >= 0 && j < i) matrix.value[at(matrix.find(i, j))] -= w;
    }
  }
  if (unknowns_.size == 0) return;
  solver_->analyze(matrix);
  solver_->factorize(matrix);
}

void Laplacian::solve(const Points& force, Points& x) const {
  if (unknowns_.size == 0) return;
  RightSides unknown(unknowns_.size, 2);
  for (std::size_t v = 0; v < unknowns_.slot.size(); ++v) {
    if (unknowns_.slot[v] >= 0) unknown.row(unknowns_.slot[v]) = force.row(static_cast<Eigen::Index>(v));
  }
  for (const Neighbour& to : neighbours_) unknown.row(to.slot) += to.weight * x.row(to.fixed);
  std::as_const(*solver_).solve(unknown);
  for (std::size_t v = 0; v < unknowns_.slot.size(); ++v) {
    if (unknowns_.slot[v] >= 0) x.row(static_cast<Eigen::Index>(v)) = unknown.row(unknowns_.slot[v]);
  }
}

}  // namespace planar
