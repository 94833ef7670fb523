// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/two_steps.h"

#include "base/complex_rows.h"
#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

}  // namespace

TwoSteps::TwoSteps(const Patch& patch, const Eigen::VectorXd& weight, std::array<int, 2> fixed)
    : fixed_(Points::Zero(patch.mesh.n_vertices, 2)),
      edges_(edge_neighbourhoods(patch.mesh, patch.rest_of())),
      weight_(weight) {
  fixed_(fixed[1], 0) = patch.length[at(patch.mesh.find_edge(fixed[0], fixed[1]))];
  std::vector<char> free(at(patch.mesh.n_vertices));
  for (const auto& [a, b] : patch.mesh.edges) free[at(a)] = free[at(b)] = 1;
  free[at(fixed[0])] = free[at(fixed[1])] = 0;
  factor_similar(free);
  adjusted_ = std::make_unique<Laplacian>(patch.mesh.edges, weight, free);
}

void TwoSteps::factor_similar(const std::vector<char>& free) {
  similar_ = HermitianSolver::create(default_backend());
  unknowns_ = std::make_unique<Unknowns>(*similar_, couplings(edges_), free);
  HermitianMatrix matrix = unknowns_->zero<Complex>();
  right_.setZero(unknowns_->size);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const EdgeNeighbourhood& edge = edges_[e];
    const std::array<Complex, 4> row = edge.left();  // of A₁
    for (std::size_t i = 0; i < edge.n_vertices; ++i) {
      const int slot = unknowns_->slot[at(edge.vertex[i])];
      if (slot < 0) continue;
      for (std::size_t j = 0; j < edge.n_vertices; ++j) {
        const int other = unknowns_->slot[at(edge.vertex[j])];
        const Complex entry = weight_[static_cast<Eigen::Index>(e)] * std::conj(row[i]) * row[j];
        if (other < 0) {
          right_[slot] -= entry * complex_row(fixed_, edge.vertex[j]);
        } else if (other <= slot) {
          matrix.value[at(matrix.find(slot, other))] += entry;
        }
      }
    }
  }
  if (unknowns_->size == 0) return;
  similar_->analyze(matrix);
  similar_->factorize(matrix);
}

Points TwoSteps::similar() const {
  Points x = fixed_;
  if (unknowns_->size == 0) return x;
  Eigen::VectorXcd unknown(right_.size());
  similar_->solve(right_, unknown);
  for (std::size_t v = 0; v < unknowns_->slot.size(); ++v) {
    const int slot = unknowns_->slot[v];
    if (slot >= 0) x.row(static_cast<Eigen::Index>(v)) << unknown[slot].real(), unknown[slot].imag();
  }
  return x;
}

Points TwoSteps::adjusted(const Points& x) const {
  std::vector<Complex> place;
  for (Eigen::Index v = 0; v < x.rows(); ++v) place.push_back(complex_row(x, v));
  Points force = Points::Zero(x.rows(), 2);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const EdgeNeighbourhood& edge = edges_[e];
    const Complex fitted = edge.fitted(place.data());
    const double size = std::abs(fitted);
    if (!(size > 0.0)) continue;
    // T/|T|: [ARAP09 6] divides by the square of |T|, which leaves no rotation.
    const Complex pull = weight_[static_cast<Eigen::Index>(e)] * std::abs(edge.edge) / size * fitted;
    const Eigen::RowVector2d way(pull.real(), pull.imag());
    force.row(edge.vertex[0]) -= way;
    force.row(edge.vertex[1]) += way;
  }
  Points result = fixed_;
  adjusted_->solve(force, result);
  return result;
}

}  // namespace planar
