// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/index.h"

namespace planar {

namespace {

using Metric = NewtonSystem::Metric;

// A factor costs more than a step, so it serves while steps shrink well.
constexpr int oldest_ahead = 6;  // steps with one factor where the next one is made ahead
constexpr int oldest = 3;        // the same where making it does not make an event wait
constexpr double aging = 0.3;    // of the step before: a step with an old factor that calls for a new one
constexpr double outdated_ahead = 0.8;  // the same, at once even if that makes the event wait
constexpr double outdated = 0.5;        // the same where it does not
constexpr double blocked = 0.1;         // a collapse before this t calls for the Killing metric
constexpr double margin = 0.8;          // of the way to the first collapse
constexpr double sufficient = 1e-4;     // Armijo's constant
constexpr double rounding = 1e-13;      // of the energy: what its evaluation may be off by
constexpr double furthest_t = 10.0;     // of steps along which the energy falls for longer than expected
constexpr double negligible = 1e-8;     // of the size: a step not worth taking
constexpr int halving_budget = 20;      // of a step
constexpr double near_minimum = 3e-3;   // of the size: a step behind which Newton's own Hessian is tried

constexpr double unlimited = std::numeric_limits<double>::infinity();

}  // namespace

Newton::Newton(const Mesh& mesh, const Springs& springs, const Eigen::VectorXd& stiffness,
               const Orientation& orientation, double size)
    : system_(mesh, springs, stiffness), orientation_(orientation), size_(size) {}

void Newton::set_energy(RestEnergy energy, double scale) {
  energy_ = std::move(energy);
  scale_ = scale;
}

void Newton::begin(const Points& x) {
  start_ = x;
  orientation_.measure(x, area_);
}

bool Newton::keeps_upright(const Points& x) {
  orientation_.measure(x, trial_area_);
  for (std::size_t t = 0; t < area_.size(); ++t) {
    if (area_[t] > 0.0 && !(trial_area_[t] > 0.0)) return false;
  }
  return true;
}

bool Newton::lessens(double value, double reached, double t, double slope, double error) {
  return reached <= value + sufficient * t * slope + error;
}

/// Fills in gradient_; the value.
double Newton::gradient(const Points& x) {
  double value = energy_.gradient(x, gradient_);
  if (scale_ != 1.0) {
    value *= scale_;
    gradient_ *= scale_;
  }
  return value + system_.springs().value(x, &gradient_);
}

Newton::Outcome Newton::descend(const Budget& budget, Points& x) {
  Outcome outcome;
  int factors = 0;
  last_length_ = unlimited;
  energy_.relax(x);
  for (int i = 0; i < budget.steps; ++i) {
    if (budget.before_step) budget.before_step();
    if (i > 0) energy_.tighten(x);
    Step step;
    step.value = gradient(x);
    if (!std::isfinite(step.value)) {
      throw SolveError("the energy is not finite: the targets are too far away or the mesh is too distorted");
    }
    const double room = budget.limit - (x - start_).rowwise().norm().maxCoeff();
    if (room < 1e-3 * budget.limit) return outcome;
    if (!has_hessian() || (!budget.ahead && age_ >= oldest)) {
      if (factors++ >= budget.factors) return outcome;
      renew(x);
    }
    aim(x, step);
    if (age_ > 0 && step.length > (budget.ahead ? outdated_ahead : outdated) * last_length_) {
      if (factors++ >= budget.factors) return outcome;
      renew(x);
      aim(x, step);
    } else if (budget.ahead && step.length > aging * last_length_) {
      age_ = oldest_ahead;
    }
    if (step.length < negligible * size_) {
      outcome.converged = true;
      return outcome;
    }
    const bool fresh = age_ == 0;
    ++outcome.iterations;
    // Where a projected step would be cut short, a bolder one leads nearer to the collapse.
    if (!budget.ahead && system_.metric() == Metric::projected && margin * step.collapse >= 1.0) {
      system_.approach_newton(energy_, scale_, x, gradient_, direction_);
      measure(x, step);
    }
    const auto use_killing = [&] {
      system_.factorize(Metric::killing, energy_, scale_, x);
      ++factors;
      aim(x, step);
    };
    if (step.collapse < blocked && factors < budget.factors) use_killing();
    search(room, x, step);
    if (step.t == 0.0 && step.length < budget.tolerance) {  // what it gains is below rounding
      outcome.converged = true;
      return outcome;
    }
    if (step.t == 0.0 && system_.metric() != Metric::killing && factors < budget.factors) {
      use_killing();
      search(room, x, step);
    }
    if (step.t == 0.0) {
      system_.forget();
      return outcome;
    }
    ++outcome.steps;
    ++age_;
    const bool full = step.t >= 1.0 && system_.metric() != Metric::killing;
    if (full && step.length < budget.tolerance && (fresh || last_length_ < unlimited)) {
      outcome.converged = true;
      return outcome;
    }
    last_length_ = last_motion_ = full ? step.length : unlimited;
    if (step.t < 0.5 || (!full && !fresh)) system_.forget();
  }
  return outcome;
}

void Newton::forget() noexcept {
  system_.forget();
  last_motion_ = unlimited;
}

bool Newton::has_hessian() const {
  return system_.metric() == Metric::newton || system_.metric() == Metric::projected;
}

/// Factors the Hessian at x, unprojected where that is likely to be positive definite.
void Newton::renew(const Points& x) {
  age_ = 0;
  if (last_motion_ < near_minimum * size_) {
    try {
      system_.factorize(Metric::newton, energy_, scale_, x);
      return;
    } catch (const SolveError&) {
      last_motion_ = unlimited;
    }
  }
  system_.factorize(Metric::projected, energy_, scale_, x);
}

bool Newton::due() const { return !has_hessian() || age_ >= oldest_ahead; }

void Newton::renew_ahead(const Points& x) noexcept {
  try {
    renew(x);
  } catch (const SolveError&) {
    // Who needs the factor tries again, and reports it if it still fails.
  }
}

void Newton::aim(const Points& x, Step& step) {
  system_.solve(gradient_, direction_);
  measure(x, step);
}

/// Fills in what the step along direction_ is.
void Newton::measure(const Points& x, Step& step) const {
  step.slope = gradient_.cwiseProduct(direction_).sum();
  step.length = direction_.rowwise().norm().maxCoeff();
  step.collapse = energy_.first_collapse(x, direction_);
}

Newton::Step Newton::step_at(const Points& x, Points& direction) {
  Step step;
  step.value = gradient(x);
  if (!std::isfinite(step.value)) return step;
  system_.factorize(Metric::projected, energy_, scale_, x);
  aim(x, step);
  direction = direction_;
  return step;
}

/// Moves x along the direction, no vertex further than `longest`.
void Newton::search(double longest, Points& x, Step& step) {
  const double length = direction_.rowwise().norm().maxCoeff();
  const double most = std::min(margin * step.collapse, longest / length);
  double t = std::min(1.0, most), reached = 0.0;
  for (int halvings = 0;; ++halvings, t *= 0.5) {
    if (halvings > halving_budget) return;
    trial_ = x + t * direction_;
    reached = value(trial_);
    if (lessens(step.value, reached, t, step.slope, rounding * std::abs(step.value)) &&
        keeps_upright(trial_)) {
      break;
    }
  }
  if (t == 1.0) {
    // Where the energy bends less than its Hessian said, further along is better still.
    const double bend = 2.0 * (reached - step.value - step.slope);
    double further = std::min(most, bend > 0.0 ? std::min(-step.slope / bend, furthest_t) : furthest_t);
    for (int tries = 0; tries < 2 && further > 1.5; ++tries, further = std::sqrt(further)) {
      further_ = x + further * direction_;
      if (!(value(further_) < reached && keeps_upright(further_))) continue;
      std::swap(trial_, further_);
      t = further;
      break;
    }
  }
  std::swap(x, trial_);
  step.t = t;
}

}  // namespace planar
