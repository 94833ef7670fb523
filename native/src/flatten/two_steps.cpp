// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/two_steps.h"

#include "base/complex_rows.h"
#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

}  // namespace

TwoSteps::TwoSteps(const Patch& patch, const Eigen::VectorXd& weight, std::array<int, 2> fixed)
    : patch_(patch), fixed_(Points::Zero(patch.mesh.n_vertices, 2)) {
  fixed_(fixed[1], 0) = patch.length[at(patch.mesh.find_edge(fixed[0], fixed[1]))];
  std::vector<char> free(at(patch.mesh.n_vertices));
  for (std::size_t e = 0; e < patch.mesh.edges.size(); ++e) {
    const auto [a, b] = patch.mesh.edges[e];
    free[at(a)] = free[at(b)] = 1;
    edges_.push_back(neighbourhood(e, weight[static_cast<Eigen::Index>(e)]));
  }
  free[at(fixed[0])] = free[at(fixed[1])] = 0;
  factor_similar(free);
  adjusted_ = std::make_unique<Laplacian>(patch.mesh.edges, weight, free);
}

TwoSteps::Neighbourhood TwoSteps::neighbourhood(std::size_t e, double weight) const {
  const auto [a, b] = patch_.mesh.edges[e];
  Neighbourhood result{{a, b, -1, -1}, {}, 2, patch_.length[e], weight};
  std::array<Complex, 4> place{0.0, result.length, 0.0, 0.0};
  // The printed d' = |d - a| (cos, sin) puts both apexes on one side of the edge; the right one is below it.
  for (const int t : patch_.beside[e]) {
    if (t < 0) continue;
    const int c = patch_.apex(e, t);
    const Complex from = patch_.corner(t, a), along = patch_.corner(t, b) - from;
    const double size = std::abs(along);
    result.vertex[result.size] = c;
    place[result.size++] = (patch_.corner(t, c) - from) * (size > 0.0 ? std::conj(along) / size : 1.0);
  }
  Complex mean = 0.0;
  for (std::size_t i = 0; i < result.size; ++i) mean += place[i] / static_cast<double>(result.size);
  double square = 0.0;
  for (std::size_t i = 0; i < result.size; ++i) square += std::norm(place[i] - mean);
  for (std::size_t i = 0; i < result.size && square > 0.0; ++i) {
    result.fit[i] = std::conj(place[i] - mean) / square;
  }
  return result;
}

Complex TwoSteps::similarity(const Neighbourhood& edge, const Points& x) {
  Complex sum = 0.0;
  for (std::size_t i = 0; i < edge.size; ++i) sum += edge.fit[i] * complex_row(x, edge.vertex[i]);
  return sum;
}

void TwoSteps::factor_similar(const std::vector<char>& free) {
  std::vector<std::array<int, 2>> couplings;
  for (const Neighbourhood& edge : edges_) {
    for (std::size_t i = 0; i < edge.size; ++i) {
      for (std::size_t j = 0; j < i; ++j) couplings.push_back({edge.vertex[i], edge.vertex[j]});
    }
  }
  similar_ = HermitianSolver::create(default_backend());
  unknowns_ = std::make_unique<Unknowns>(*similar_, couplings, free);
  HermitianMatrix matrix = unknowns_->zero<Complex>();
  right_.setZero(unknowns_->size);
  for (const Neighbourhood& edge : edges_) {
    // The edge's row of A₁: x_b - x_a - T · length.
    std::array<Complex, 4> row;
    for (std::size_t i = 0; i < edge.size; ++i) row[i] = -edge.length * edge.fit[i];
    row[0] -= 1.0;
    row[1] += 1.0;
    for (std::size_t i = 0; i < edge.size; ++i) {
      const int slot = unknowns_->slot[at(edge.vertex[i])];
      if (slot < 0) continue;
      for (std::size_t j = 0; j < edge.size; ++j) {
        const int other = unknowns_->slot[at(edge.vertex[j])];
        const Complex entry = edge.weight * std::conj(row[i]) * row[j];
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
  Points force = Points::Zero(x.rows(), 2);
  for (const Neighbourhood& edge : edges_) {
    const Complex t = similarity(edge, x);
    const double size = std::abs(t);
    if (!(size > 0.0)) continue;
    // [ARAP09 6] divides by the square of this, which leaves no rotation.
    const Complex pull = edge.weight * edge.length / size * t;
    const Eigen::RowVector2d way(pull.real(), pull.imag());
    force.row(edge.vertex[0]) -= way;
    force.row(edge.vertex[1]) += way;
  }
  Points result = fixed_;
  adjusted_->solve(force, result);
  return result;
}

}  // namespace planar
