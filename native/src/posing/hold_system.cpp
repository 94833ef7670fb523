// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/hold_system.h"

#include <utility>

#include "base/index.h"

namespace planar {

namespace {

constexpr double regularization = 1e-9;  // of the metric; 1 is the order of a triangle's blocks
constexpr double most_regularization = 1.0;
constexpr int worth_a_thread = 1000;  // vertices

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

HoldSystem::HoldSystem(const Mesh& mesh, const Points& rest, const Orientation& orientation,
                       const Eigen::VectorXd& stiffness)
    : mesh_(mesh),
      solver_(SparseSolver::create(default_backend())),
      matrix_(mesh_, numbered(mesh_, *solver_)),
      rest_energy_(rest, matrix_, orientation, stiffness),
      stiffness_(stiffness),
      active_(at(mesh_.n_parts)),
      turn_(at(mesh_.n_parts), 1.0) {
  solver_->analyze(matrix_.matrix());
}

void HoldSystem::set_pins(std::vector<Pin> pins, std::vector<char> active) noexcept {
  forget();
  pins_ = std::move(pins);
  active_ = std::move(active);
}

void HoldSystem::forget() noexcept {
  join();
  metric_ = Metric::none;
}

void HoldSystem::factorize(Metric metric, const Points& x) {
  metric_ = Metric::none;
  // What the metric is given by: the Killing matrix is half the Hessian of its energy.
  double scale = 1.0;
  if (metric == Metric::killing) {
    matrix_.assemble(x, stiffness_, active_);
    scale = 0.5;
  } else {
    matrix_.set_zero();
    rest_energy_.add_hessian(x, active_, matrix_, metric == Metric::projected);
    matrix_.set_unit_rows(active_);
  }
  for (const Pin& pin : pins_) {
    for (std::size_t a = 0; a < pin.n_corners; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        matrix_.add(pin.vertex[a], pin.vertex[b], 2.0 * scale * pin.strength * pin.weight[a] * pin.weight[b]);
      }
    }
  }
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
      if (metric == Metric::exact || more >= most_regularization) throw;
    }
  }
  metric_ = metric;
  turn_.assign(turn_.size(), 1.0);
}

void HoldSystem::factorize_ahead(const Points& x) {
  ahead_ = x;
  const auto task = [this] {
    try {
      factorize(Metric::projected, ahead_);
    } catch (const SolveError&) {
      // metric() says so; who needs the factor tries again, and reports it if it still fails.
    }
  };
  if (mesh_.n_vertices >= worth_a_thread) {
    worker_.start(task);
  } else {
    task();
  }
}

void HoldSystem::join() noexcept { worker_.wait(); }

void HoldSystem::solve(const Points& gradient, Points& direction) {
  using Complex = std::complex<double>;
  unknown_.setZero(matrix_.matrix().size);
  const double scale = metric_ == Metric::killing ? -0.5 : -1.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!is_active(v)) continue;
    const Complex g =
        scale * std::conj(turn_[at(mesh_.part[at(v)])]) * Complex(gradient(v, 0), gradient(v, 1));
    unknown_.segment<2>(2 * matrix_.place(v)) << g.real(), g.imag();
  }
  solver_->solve(unknown_, unknown_);
  direction.setZero(mesh_.n_vertices, 2);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!is_active(v)) continue;
    const int place = 2 * matrix_.place(v);
    const Complex d = turn_[at(mesh_.part[at(v)])] * Complex(unknown_[place], unknown_[place + 1]);
    direction.row(v) << d.real(), d.imag();
  }
}

void HoldSystem::turn(const std::vector<std::complex<double>>& by_part) {
  for (std::size_t part = 0; part < turn_.size(); ++part) turn_[part] *= by_part[part];
}

}  // namespace planar
