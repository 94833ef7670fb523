// SPDX-License-Identifier: GPL-3.0-or-later
#include "hold_method.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

namespace planar {

namespace {

const int move_steps = 2;
const int move_factors = 2;
const int settle_budget = 200;
const int oldest = 3;  // steps with one factor
constexpr double contraction = 0.5;
constexpr double blocked = 0.5;
constexpr double margin = 0.8;
constexpr double sufficient = 1e-4;
constexpr double settled = 1e-5;  // of the box diagonal
constexpr double worth_following = 0.5;
const int following_budget = 5;
constexpr int backtracking_budget = 20;
constexpr double regularization = 1e-9;
constexpr double unlimited = std::numeric_limits<double>::infinity();

using Complex = std::complex<double>;

Complex complex(const Eigen::RowVector2d& p) { return {p.x(), p.y()}; }

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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

HoldMethod::HoldMethod(const Points& rest, const Triangles& triangles, const Eigen::VectorXd& stiffness)
    : mesh_(rest.rows(), triangles),
      solver_(SparseSolver::create(default_backend())),
      matrix_(mesh_, numbered(mesh_, *solver_)),
      orientation_(rest, mesh_.triangles),
      rest_energy_(rest, matrix_, orientation_, stiffness),
      stiffness_(stiffness),
      diagonal_((rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm()) {
  solver_->analyze(matrix_.matrix());
}

void HoldMethod::set_handles(const HandleSet& set) {
  std::vector<Pin> pins = make_pins(mesh_, set.handles, set.strength, set.patch);
  std::vector<char> active(at(mesh_.n_parts));
  for (const Pin& pin : pins) active[at(pin.part)] = 1;
  pins_ = std::move(pins);
  active_ = std::move(active);
  factor_ = Factor::none;
}

void HoldMethod::set_targets(const Points& targets) {
  for (Pin& pin : pins_) {
    pin.position.setZero();
    for (const int row : pin.rows) pin.position += targets.row(row) / static_cast<double>(pin.rows.size());
  }
}

void HoldMethod::move(const Points& targets, Points& x, Report& report) {
  descend(targets, {move_steps, move_factors, unlimited}, x, report);
}

void HoldMethod::refine(const Points& targets, Points& x, Report& report) {
  descend(targets, {move_steps, move_factors, refine_limit * diagonal_}, x, report);
}

void HoldMethod::settle(const Points& targets, Points& x, Report& report) {
  descend(targets, {settle_budget, settle_budget, unlimited}, x, report);
}

namespace {

Eigen::RowVector2d point_of(const Pin& pin, const Points& x) {
  Eigen::RowVector2d p = Eigen::RowVector2d::Zero();
  for (std::size_t c = 0; c < pin.n_corners; ++c) p += pin.weight[c] * x.row(pin.vertex[c]);
  return p;
}

}  // namespace

double HoldMethod::pull(const Points& x, Points* gradient) const {
  double sum = 0.0;
  for (const Pin& pin : pins_) {
    const Eigen::RowVector2d left = point_of(pin, x) - pin.position;
    sum += pin.strength * left.squaredNorm();
    if (gradient == nullptr) continue;
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      gradient->row(pin.vertex[c]) += 2.0 * pin.strength * pin.weight[c] * left;
    }
  }
  return sum;
}

double HoldMethod::energy(const Points& x) const { return rest_energy_.value(x) + pull(x, nullptr); }

/// Fits a rigid motion to the pins of each part and takes x along where that is worth it, no vertex further
/// than `limit`.
bool HoldMethod::follow_rigidly(double limit, Points& x) {
  struct Fit {
    double weight = 0.0, before = 0.0, after = 0.0, angle = 0.0;
    Complex centre = 0.0, target = 0.0, turn = 0.0;
  };
  std::vector<Fit> fits(at(mesh_.n_parts));
  for (const Pin& pin : pins_) {
    Fit& fit = fits[at(pin.part)];
    fit.weight += pin.strength;
    fit.centre += pin.strength * complex(point_of(pin, x));
    fit.target += pin.strength * complex(pin.position);
  }
  for (Fit& fit : fits) {
    if (fit.weight == 0.0) continue;
    fit.centre /= fit.weight;
    fit.target /= fit.weight;
  }
  for (const Pin& pin : pins_) {
    Fit& fit = fits[at(pin.part)];
    const Complex from = complex(point_of(pin, x)) - fit.centre;
    fit.turn += pin.strength * std::conj(from) * (complex(pin.position) - fit.target);
  }
  for (Fit& fit : fits) fit.angle = std::arg(fit.turn);
  for (const Pin& pin : pins_) {
    Fit& fit = fits[at(pin.part)];
    const Complex p = complex(point_of(pin, x)), q = complex(pin.position);
    fit.before += pin.strength * std::norm(q - p);
    fit.after += pin.strength * std::norm(q - fit.target - std::polar(1.0, fit.angle) * (p - fit.centre));
  }
  double furthest = 0.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (mesh_.part[at(v)] < 0) continue;
    Fit& fit = fits[at(mesh_.part[at(v)])];
    if (!(fit.after <= worth_following * fit.before)) fit.weight = 0.0;
    if (fit.weight == 0.0) continue;
    const double way =
        std::abs(fit.target - fit.centre) + std::abs(fit.angle) * std::abs(complex(x.row(v)) - fit.centre);
    furthest = std::max(furthest, way);
  }
  if (furthest == 0.0) return false;
  double share = furthest > limit ? limit / furthest : 1.0;
  for (int tries = 0; tries < following_budget; ++tries, share *= 0.5) {
    trial_ = x;
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (mesh_.part[at(v)] < 0) continue;
      const Fit& fit = fits[at(mesh_.part[at(v)])];
      if (fit.weight == 0.0) continue;
      const Complex p = fit.centre + share * (fit.target - fit.centre) +
                        std::polar(1.0, share * fit.angle) * (complex(x.row(v)) - fit.centre);
      trial_.row(v) << p.real(), p.imag();
    }
    if (keeps_upright(trial_)) {
      std::swap(x, trial_);
      return share < 1.0;
    }
  }
  return false;
}

void HoldMethod::factorize(Factor kind, const Points& x) {
  factor_ = Factor::none;
  if (kind == Factor::killing) {
    // 2K, like 2μ: the Hessian of the energy whose gradient is 2Kx; both sides are halved.
    matrix_.assemble(x, stiffness_, active_);
  } else {
    matrix_.set_zero();
    rest_energy_.add_hessian(x, active_, matrix_);
    matrix_.set_unit_rows(active_);
  }
  const double half = kind == Factor::killing ? 1.0 : 2.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (mesh_.part[at(v)] >= 0) matrix_.add(v, v, regularization);
  }
  for (const Pin& pin : pins_) {
    for (std::size_t a = 0; a < pin.n_corners; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        matrix_.add(pin.vertex[a], pin.vertex[b], half * pin.strength * pin.weight[a] * pin.weight[b]);
      }
    }
  }
  solver_->factorize(matrix_.matrix());
  factor_ = kind;
  age_ = 0;
}

void HoldMethod::solve() {
  unknown_.resize(matrix_.matrix().size);
  const double scale = factor_ == Factor::killing ? -0.5 : -1.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int place = matrix_.place(v);
    if (place >= 0) unknown_.segment<2>(2 * place) = scale * gradient_.row(v).transpose();
  }
  solver_->solve(unknown_, unknown_);
  direction_.setZero(mesh_.n_vertices, 2);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int place = matrix_.place(v);
    if (place >= 0 && active_[at(mesh_.part[at(v)])])
      direction_.row(v) = unknown_.segment<2>(2 * place).transpose();
  }
}

bool HoldMethod::keeps_upright(const Points& x) {
  orientation_.measure(x, trial_area_);
  for (std::size_t t = 0; t < area_.size(); ++t) {
    if (area_[t] > 0.0 && !(trial_area_[t] > 0.0)) return false;
  }
  return true;
}

void HoldMethod::descend(const Points& targets, const Budget& budget, Points& x, Report& report) {
  report.converged = pins_.empty();
  if (pins_.empty()) return;
  set_targets(targets);
  const Points start = x;
  orientation_.measure(x, area_);
  const bool underway = follow_rigidly(budget.limit, x);
  rest_energy_.relax(x);
  int factors = 0;
  double last = unlimited;
  for (int step = 0; step < budget.steps; ++step) {
    ++report.iterations;
    if (step > 0) rest_energy_.tighten(x);
    double value = rest_energy_.gradient(x, gradient_);
    value += pull(x, &gradient_);
    for (int v = 0; v < mesh_.n_vertices; ++v)
      if (mesh_.part[at(v)] < 0 || !active_[at(mesh_.part[at(v)])]) gradient_.row(v).setZero();
    if (factor_ != Factor::newton || age_ >= oldest) {
      if (factors == budget.factors) return;
      factorize(Factor::newton, x);
      ++factors;
    }
    solve();
    double longest = direction_.rowwise().norm().maxCoeff();
    if (age_ > 0 && longest > contraction * last && factors < budget.factors) {
      factorize(Factor::newton, x);
      ++factors;
      solve();
      longest = direction_.rowwise().norm().maxCoeff();
    }
    double collapse = rest_energy_.first_collapse(x, direction_);
    if (collapse < blocked && factors < budget.factors) {
      factorize(Factor::killing, x);
      ++factors;
      solve();
      collapse = rest_energy_.first_collapse(x, direction_);
      longest = direction_.rowwise().norm().maxCoeff();
    }
    last = longest;
    const double slope = gradient_.cwiseProduct(direction_).sum();
    const double room = budget.limit - (x - start).rowwise().norm().maxCoeff();
    if (room < 1e-3 * budget.limit) return;
    double t = std::min({1.0, margin * collapse, room / longest});
    int tries = 0;
    for (;; t *= 0.5) {
      trial_ = x + t * direction_;
      if (energy(trial_) <= value + sufficient * t * slope + 1e-13 * std::abs(value) && keeps_upright(trial_))
        break;
      if (++tries > backtracking_budget) {
        t = 0.0;
        break;
      }
    }
    ++age_;
    ++report.substeps;
    if (t > 0.0) std::swap(x, trial_);
    if (factor_ == Factor::newton && t == 1.0 && !underway && longest < settled * diagonal_) {
      report.converged = true;
      return;
    }
    if (t < 1.0) {
      last = unlimited;
      if (factor_ == Factor::newton && age_ > 1) factor_ = Factor::none;
      if (t == 0.0 && age_ == 1) return;
      if (t < 0.5) factor_ = Factor::none;
    }
  }
}

}  // namespace planar
