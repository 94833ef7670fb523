// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/newton_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.h"

namespace planar {

namespace {

constexpr double regularization = 1e-9;       // of the metric; 1 is the order of a triangle's blocks
constexpr double most_regularization = 1e-3;  // of the largest entry, if that is more than 1
// Of conjugate gradients. Of 640 drags of ten characters that were hard to settle, half of them with slivers,
// 2 take more than 60 Newton steps with five; 12 did without any.
constexpr int most_conjugate = 5;
constexpr double accuracy = 0.1;  // of what is left of the gradient, in the metric; 0.03 hardly saves a step

std::vector<int> numbered(const Mesh& mesh, SparseSolver& solver,
                          const std::vector<std::array<int, 2>>& links = {}) {
  std::vector<int> used;
  for (int v = 0; v < mesh.n_vertices; ++v) {
    if (mesh.part[at(v)] >= 0) used.push_back(v);
  }
  std::vector<int> result;
  result.reserve(used.size());
  for (const int k : solver.fill_reducing_order(vertex_graph(mesh, used, links)))
    result.push_back(used[at(k)]);
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

void NewtonSystem::link(const std::vector<std::array<int, 2>>& pairs) {
  std::unique_ptr<SparseSolver> solver = SparseSolver::create(default_backend());
  KillingMatrix matrix(mesh_, numbered(mesh_, *solver, pairs), pairs);
  solver->analyze(matrix.matrix());
  forget();
  solver_ = std::move(solver);
  matrix_ = std::move(matrix);
}

void NewtonSystem::set_active(std::vector<char> active) noexcept {
  forget();
  active_ = std::move(active);
}

void NewtonSystem::factorize(Metric metric, const RestEnergy& energy, double scale, const Points& x) {
  metric_ = Metric::none;
  // Of what the metric is: the Killing matrix is half the Hessian of its energy.
  double part = 1.0;
  if (metric == Metric::killing) {
    matrix_.assemble(x, stiffness_, active_);
    part = 0.5;
  } else {
    matrix_.set_zero();
    using Hessian = RestEnergy::Hessian;
    energy.add_hessian(x, active_, matrix_, metric == Metric::newton ? Hessian::full : Hessian::projected);
    matrix_.set_unit_rows(active_);
  }
  scale_and_add_springs(scale, part);
  // Slivers that are nearly collapsed and very stiff leave rounding errors larger than the smallest
  // eigenvalues; but never ones as large as the last regularization, where the metric is semidefinite.
  const double most = metric == Metric::newton ? 0.0 : std::max(1.0, most_regularization * matrix_.largest());
  for (double more = regularization;; more *= 1e3) {
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (is_active(v)) matrix_.add(v, more * Eigen::Matrix2d::Identity());
    }
    try {
      solver_->factorize(matrix_.matrix());
      break;
    } catch (const SolveError&) {
      if (!(more < most) || !std::isfinite(most)) throw;
    }
  }
  metric_ = metric;
  turn_.assign(turn_.size(), 1.0);
}

void NewtonSystem::scale_and_add_springs(double scale, double springs) {
  if (scale != 1.0) {
    for (std::size_t i = 0; i < matrix_.matrix().row.size(); ++i) matrix_.values()[i] *= scale;
  }
  springs_.add_hessian(matrix_, springs);
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

Points NewtonSystem::times(const Points& x) const {
  Eigen::VectorXd in = Eigen::VectorXd::Zero(matrix_.matrix().size);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (is_active(v)) in.segment<2>(2 * matrix_.slot(v)) = x.row(v).transpose();
  }
  const Eigen::VectorXd out = matrix_.matrix().times(in);
  Points result = Points::Zero(mesh_.n_vertices, 2);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (is_active(v)) result.row(v) = out.segment<2>(2 * matrix_.slot(v)).transpose();
  }
  return result;
}

void NewtonSystem::approach_newton(const RestEnergy& energy, double scale, const Points& x,
                                   const Points& gradient, Points& direction) {
  matrix_.set_zero();
  energy.add_hessian(x, active_, matrix_, RestEnergy::Hessian::full);
  matrix_.set_unit_rows(active_);
  scale_and_add_springs(scale, 1.0);
  Points left = gradient;  // of the gradient, with what the direction takes off
  Points along = direction, preconditioned;
  double decrease = -left.cwiseProduct(along).sum();
  const double enough = accuracy * accuracy * decrease;
  for (int i = 0; i < most_conjugate && decrease > enough; ++i) {
    const Points product = times(along);
    const double curvature = along.cwiseProduct(product).sum();
    if (!(curvature > 0.0)) return;
    const double step = decrease / curvature;
    if (i == 0) direction.setZero();
    direction += step * along;
    left += step * product;
    solve(left, preconditioned);
    const double before = std::exchange(decrease, -left.cwiseProduct(preconditioned).sum());
    along = preconditioned + (decrease / before) * along;
  }
}

void NewtonSystem::turn(const std::vector<std::complex<double>>& by_part) {
  for (std::size_t part = 0; part < turn_.size(); ++part) turn_[part] *= by_part[part];
}

}  // namespace planar
