// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/newton_system.h"

#include <utility>

#include "base/index.h"

namespace planar {

namespace {

constexpr double regularization = 1e-9;  // of the metric; 1 is the order of a triangle's blocks
constexpr double most_regularization = 1.0;

std::vector<int> numbered(const Mesh& mesh, SparseSolver& solver) {
  std::vector<int> used;
  for (int v = 0; v < mesh.n_vertices; ++v) {
    if (mesh.part[at(v)] >= 0) used.push_back(v);
  }
  std::vector<int> result;
  result.reserve(used.size());
  for (const int k : solver.fill_reducing_order(vertex_graph(mesh, used))) result.push_back(used[at(k)]);
  return result;
}

}  // namespace

NewtonSystem::NewtonSystem(const Mesh& mesh, const Springs& springs, const Eigen::VectorXd& stiffness)
    : mesh_(mesh),
      springs_(springs),
      solver_(SparseSolver::create(default_backend())),
      matrix_(mesh_, numbered(mesh_, *solver_)),
      stiffness_(stiffness),
      active_(at(mesh_.n_parts), 1),
      turn_(at(mesh_.n_parts), 1.0) {
  solver_->analyze(matrix_.matrix());
}

void NewtonSystem::set_active(std::vector<char> active) noexcept {
  forget();
  active_ = std::move(active);
}

void NewtonSystem::factorize(Metric metric, const RestEnergy& energy, double scale, const Points& x,
                             double negative) {
  metric_ = Metric::none;
  // Of what the metric is: the Killing matrix is half the Hessian of its energy.
  double part = 1.0;
  if (metric == Metric::killing) {
    matrix_.assemble(x, stiffness_, active_);
    part = 0.5;
  } else {
    matrix_.set_zero();
    energy.add_hessian(x, active_, matrix_, negative);
    matrix_.set_unit_rows(active_);
  }
  if (scale != 1.0) {
    for (std::size_t i = 0; i < matrix_.matrix().row.size(); ++i) matrix_.values()[i] *= scale;
  }
  springs_.add_hessian(matrix_, part);
  // Slivers that are nearly collapsed and very stiff leave rounding errors larger than the smallest
  // eigenvalues.
  for (double more = regularization;; more *= 1e3) {
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (is_active(v)) matrix_.add(v, v, more);
    }
    try {
      solver_->factorize(matrix_.matrix());
      break;
    } catch (const SolveError&) {
      if (metric == Metric::curved || more >= most_regularization) throw;
    }
  }
  metric_ = metric;
  turn_.assign(turn_.size(), 1.0);
}

void NewtonSystem::solve(const Points& gradient, Points& direction) {
  using Complex = std::complex<double>;
  unknown_.setZero(matrix_.matrix().size);
  const double scale = metric_ == Metric::killing ? -0.5 : -1.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!is_active(v)) continue;
    const Complex g =
        scale * std::conj(turn_[at(mesh_.part[at(v)])]) * Complex(gradient(v, 0), gradient(v, 1));
    unknown_.segment<2>(2 * matrix_.slot(v)) << g.real(), g.imag();
  }
  solver_->solve(unknown_, unknown_);
  direction.setZero(mesh_.n_vertices, 2);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!is_active(v)) continue;
    const int slot = 2 * matrix_.slot(v);
    const Complex d = turn_[at(mesh_.part[at(v)])] * Complex(unknown_[slot], unknown_[slot + 1]);
    direction.row(v) << d.real(), d.imag();
  }
}

void NewtonSystem::turn(const std::vector<std::complex<double>>& by_part) {
  for (std::size_t part = 0; part < turn_.size(); ++part) turn_[part] *= by_part[part];
}

}  // namespace planar
