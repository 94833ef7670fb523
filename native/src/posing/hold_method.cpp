// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/hold_method.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "base/complex_rows.h"
#include "base/index.h"
#include "energy/rigid_fit.h"

namespace planar {

namespace {

using Complex = std::complex<double>;
using Metric = HoldSystem::Metric;

constexpr int move_steps = 2;
constexpr int move_factors = 2;
constexpr int move_oldest = 6;      // steps with one factor, over several moves
constexpr int settle_oldest = 3;    // the same in settle()
constexpr int settle_budget = 200;  // steps, and factors
constexpr double aging = 0.3;       // of the step before: a step with an old factor that calls for a new one
constexpr double outdated = 0.8;    // the same, at once even if that makes the event wait
constexpr double settle_outdated = 0.5;  // the same in settle()
constexpr double blocked = 0.1;          // a collapse before this t calls for the Killing metric
constexpr double margin = 0.8;           // of the way to the first collapse
constexpr double sufficient = 1e-4;      // Armijo's constant
constexpr double rounding = 1e-13;       // of the energy: what its evaluation may be off by
constexpr double furthest_t = 10.0;      // of steps along which the energy falls for longer than expected
constexpr double settled = 1e-5;         // of the box diagonal
constexpr double negligible = 1e-8;      // of the box diagonal: a step not worth taking
constexpr double near = 5e-3;            // of the box diagonal: steps for which the exact Hessian may serve
constexpr double worth_following = 0.3;  // of the pins' energy: what a rigid motion may leave of it
constexpr int following_budget = 8;      // halvings of that motion
constexpr int halving_budget = 20;       // of a step
constexpr int longest_pause = 8;         // factors

constexpr double unlimited = std::numeric_limits<double>::infinity();

}  // namespace

HoldMethod::HoldMethod(const Points& rest, const Triangles& triangles, const Orientation& orientation,
                       const Eigen::VectorXd& stiffness)
    : mesh_(rest.rows(), triangles),
      orientation_(orientation),
      system_(mesh_, rest, orientation_, stiffness),
      diagonal_((rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm()) {}

void HoldMethod::set_handles(const HandleSet& set) {
  std::vector<Pin> pins = make_pins(mesh_, set.handles, set.strength, set.patch);
  std::vector<char> active(at(mesh_.n_parts));
  for (const Pin& pin : pins) active[at(pin.part)] = 1;
  std::vector<Pin> copy = pins;
  system_.set_pins(std::move(copy), std::move(active));
  pins_ = std::move(pins);
}

void HoldMethod::reset() noexcept { system_.forget(); }

void HoldMethod::move(const Points& targets, Points& x, Report& report) {
  descend(targets, {move_steps, move_factors, true, unlimited}, x, report);
}

void HoldMethod::refine(const Points& targets, Points& x, Report& report) {
  descend(targets, {move_steps, move_factors, true, refine_limit * diagonal_}, x, report);
}

void HoldMethod::settle(const Points& targets, Points& x, Report& report) {
  descend(targets, {settle_budget, settle_budget, false, unlimited}, x, report);
}

void HoldMethod::descend(const Points& targets, const Budget& budget, Points& x, Report& report) {
  report.converged = pins_.empty();
  if (pins_.empty()) return;
  system_.join();
  for (Pin& pin : pins_) {
    pin.position.setZero();
    for (const int row : pin.rows) pin.position += targets.row(row) / static_cast<double>(pin.rows.size());
  }
  const Points start = x;
  orientation_.measure(x, area_);
  try {
    const bool underway = follow_rigidly(budget.limit, x);
    system_.rest_energy().relax(x);
    descend_steps(budget, start, x, report);
    if (underway) report.converged = false;
  } catch (...) {
    system_.forget();
    throw;
  }
  if (budget.ahead && !report.converged && (system_.metric() != Metric::projected || age_ >= move_oldest)) {
    system_.factorize_ahead(x);
    age_ = 0;
  }
}

/// Takes the parts along with their pins where that is a rigid motion for the most part, no vertex further
/// than `limit`; true if the limit stopped it.
bool HoldMethod::follow_rigidly(double limit, Points& x) {
  std::vector<PointPair> pairs;
  pairs.reserve(pins_.size());
  for (const Pin& pin : pins_) {
    pairs.push_back(
        {pin.part, pin.strength, complex_point(pinned_point(pin, x)), complex_point(pin.position)});
  }
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, pairs);
  // Σ strength |pin - its target|² of each part without and with its motion.
  std::vector<double> before(motions.size()), after(motions.size());
  for (const PointPair& pair : pairs) {
    before[at(pair.part)] += pair.weight * std::norm(pair.to - pair.from);
    after[at(pair.part)] += pair.weight * std::norm(pair.to - motions[at(pair.part)].at(pair.from, 1.0));
  }
  const auto follows = [&](std::size_t part) {
    return before[part] > 0.0 && after[part] <= worth_following * before[part];
  };
  double furthest = 0.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!system_.is_active(v) || !follows(at(mesh_.part[at(v)]))) continue;
    const RigidMotion& motion = motions[at(mesh_.part[at(v)])];
    furthest = std::max(furthest, std::abs(motion.to - motion.from) +
                                      std::abs(motion.angle) * std::abs(complex_row(x, v) - motion.from));
  }
  if (furthest <= negligible * diagonal_) return false;
  double share = furthest > limit ? limit / furthest : 1.0;
  for (int halvings = 0; halvings <= following_budget; ++halvings, share *= 0.5) {
    trial_ = x;
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (!system_.is_active(v) || !follows(at(mesh_.part[at(v)]))) continue;
      const Complex p = motions[at(mesh_.part[at(v)])].at(complex_row(x, v), share);
      trial_.row(v) << p.real(), p.imag();
    }
    if (!keeps_upright(trial_)) continue;
    std::vector<Complex> turn(motions.size(), 1.0);
    for (std::size_t part = 0; part < motions.size(); ++part) {
      if (follows(part)) turn[part] = std::polar(1.0, share * motions[part].angle);
    }
    system_.turn(turn);
    std::swap(x, trial_);
    return share < 1.0;
  }
  return false;
}

void HoldMethod::descend_steps(const Budget& budget, const Points& start, Points& x, Report& report) {
  RestEnergy& rest_energy = system_.rest_energy();
  int factors = 0;
  last_length_ = unlimited;
  slow_ = false;
  exact_pause_ = exact_failures_ = 0;
  for (int i = 0; i < budget.steps; ++i) {
    if (i > 0) rest_energy.tighten(x);
    const double value = rest_energy.gradient(x, gradient_) + pull(x, &gradient_);
    if (!std::isfinite(value)) {
      throw SolveError("the energy is not finite: the targets are too far away or the mesh is too distorted");
    }
    const double room = budget.limit - (x - start).rowwise().norm().maxCoeff();
    if (room < 1e-3 * budget.limit) return;
    const bool lacking = system_.metric() == Metric::none || system_.metric() == Metric::killing;
    if (lacking || (!budget.ahead && age_ >= settle_oldest)) {
      if (factors >= budget.factors) return;
      renew(x, factors);
    }
    Step step = aim(x);
    if (age_ > 0 && step.length > (budget.ahead ? outdated : settle_outdated) * last_length_) {
      if (factors >= budget.factors) return;
      renew(x, factors);
      step = aim(x);
    } else if (budget.ahead && step.length > aging * last_length_) {
      age_ = move_oldest;
    }
    if (step.length < negligible * diagonal_) {
      report.converged = true;
      return;
    }
    const bool fresh = age_ == 0;
    ++report.iterations;
    const auto use_killing = [&] {
      system_.factorize(Metric::killing, x);
      ++factors;
      step = aim(x);
    };
    if (step.collapse < blocked && factors < budget.factors) use_killing();
    search(value, room, x, step);
    if (step.t == 0.0 && system_.metric() != Metric::killing && factors < budget.factors) {
      use_killing();
      search(value, room, x, step);
    }
    if (step.t == 0.0) {
      system_.forget();
      return;
    }
    ++report.substeps;
    ++age_;
    const bool full = step.t >= 1.0 && system_.metric() != Metric::killing;
    if (full && step.length < settled * diagonal_ && (fresh || last_length_ < unlimited)) {
      report.converged = true;
      return;
    }
    slow_ = full && fresh && step.length > settle_outdated * last_length_ && step.length < near * diagonal_;
    last_length_ = full ? step.length : unlimited;
    if (step.t < 0.5 || (!full && !fresh)) system_.forget();
  }
}

/// Makes a new factor at x. The exact Hessian is tried where the projected one is too stiff to get on, and
/// less and less often where it is found not to be positive definite.
void HoldMethod::renew(const Points& x, int& factors) {
  age_ = 0;
  ++factors;
  if (slow_ && --exact_pause_ < 0) {
    try {
      system_.factorize(Metric::exact, x);
      exact_failures_ = 0;
      return;
    } catch (const SolveError&) {
      exact_pause_ = std::min(longest_pause, 1 << exact_failures_);
      ++exact_failures_;
      ++factors;
    }
  }
  system_.factorize(Metric::projected, x);
}

HoldMethod::Step HoldMethod::aim(const Points& x) {
  system_.solve(gradient_, direction_);
  return {direction_.rowwise().norm().maxCoeff(), system_.rest_energy().first_collapse(x, direction_)};
}

/// Moves x along the direction, no vertex further than `longest`.
void HoldMethod::search(double value, double longest, Points& x, Step& step) {
  const double slope = gradient_.cwiseProduct(direction_).sum();
  const double most = std::min(margin * step.collapse, longest / step.length);
  double t = std::min(1.0, most), reached = 0.0;
  for (int halvings = 0;; ++halvings, t *= 0.5) {
    if (halvings > halving_budget) return;
    trial_ = x + t * direction_;
    reached = energy(trial_);
    if (reached <= value + sufficient * t * slope + rounding * std::abs(value) && keeps_upright(trial_))
      break;
  }
  if (t == 1.0) {
    // Where the energy bends less than its Hessian said, further along is better still.
    const double bend = 2.0 * (reached - value - slope);
    double further = std::min(most, bend > 0.0 ? std::min(-slope / bend, furthest_t) : furthest_t);
    for (int tries = 0; tries < 2 && further > 1.5; ++tries, further = std::sqrt(further)) {
      further_ = x + further * direction_;
      if (!(energy(further_) < reached && keeps_upright(further_))) continue;
      std::swap(trial_, further_);
      t = further;
      break;
    }
  }
  std::swap(x, trial_);
  step.t = t;
}

double HoldMethod::pull(const Points& x, Points* gradient) const {
  double sum = 0.0;
  for (const Pin& pin : pins_) {
    const Eigen::RowVector2d left = pinned_point(pin, x) - pin.position;
    sum += pin.strength * left.squaredNorm();
    if (gradient == nullptr) continue;
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      gradient->row(pin.vertex[c]) += 2.0 * pin.strength * pin.weight[c] * left;
    }
  }
  return sum;
}

/// No triangle that lay as at rest when the call began does so no longer, as float32.
bool HoldMethod::keeps_upright(const Points& x) {
  orientation_.measure(x, trial_area_);
  for (std::size_t t = 0; t < area_.size(); ++t) {
    if (area_[t] > 0.0 && !(trial_area_[t] > 0.0)) return false;
  }
  return true;
}

}  // namespace planar
