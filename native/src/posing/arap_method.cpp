// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/arap_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/complex_product.h"
#include "base/complex_rows.h"
#include "base/diameter.h"
#include "base/index.h"
#include "linear/anderson.h"

namespace planar {

namespace {

// Of the diameter. Pins nearer to each other cannot say how to turn: the least eigenvalue of the system is
// about w d²/n for pins d apart, with 100k vertices then some hundred times what rounding makes of 0.
constexpr double one_point = 5e-6;
constexpr double tolerance = 1e-5;  // of the diameter
constexpr int settle_budget = 500;  // iterations: poses of drawings with 1k to 2k vertices take 36 to 247

/// A power of two near the size of the rest: dividing by it loses no digit.
double unit_of(const Points& rest) {
  const double size = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).maxCoeff();
  int exponent = 0;
  std::frexp(std::min(size, std::numeric_limits<double>::max()), &exponent);
  return std::ldexp(1.0, exponent - 1);
}

RestOf in(const Points& rest) {
  return [&rest](int, int v) -> Eigen::Vector2d { return rest.row(v); };
}

}  // namespace

ArapMethod::ArapMethod(const Points& rest, const Triangles& triangles, const Eigen::VectorXd& stiffness,
                       ArapWeights weights)
    : unit_(unit_of(rest)),
      rest_(rest / unit_),
      size_(diameter(rest_)),
      mesh_(rest_.rows(), triangles),
      solver_(mesh_, in(rest_), edge_weights(mesh_, in(rest_), weights, stiffness)),
      pinned_(at(mesh_.n_parts)),
      determined_(pinned_),
      centre_(pinned_.size()),
      start_(pinned_.size()) {}

void ArapMethod::set_handles(const HandleSet& set) {
  Pins pins = make_pins(mesh_, set.handles, set.strength, set.patch);
  std::vector<char> determined = determined_parts(pins), pinned(determined.size());
  for (const Pin& pin : pins) pinned[at(pin.part)] = 1;
  factored_ = false;  // should it fail, those of before are factored by the next move
  solver_.factor(pins, determined);
  factored_ = true;
  pins_ = std::move(pins);
  determined_ = std::move(determined);
  pinned_ = std::move(pinned);
}

/// Those with pins in two places.
std::vector<char> ArapMethod::determined_parts(const Pins& pins) const {
  std::vector<char> result(at(mesh_.n_parts));
  std::vector<const Pin*> first(result.size());
  for (const Pin& pin : pins) {
    const Pin*& other = first[at(pin.part)];
    if (other == nullptr) other = &pin;
    const double apart = (pinned_point(pin, rest_) - pinned_point(*other, rest_)).norm();
    if (apart > one_point * size_) result[at(pin.part)] = 1;
  }
  return result;
}

void ArapMethod::take_targets(const Points& targets) {
  std::vector<double> weight(centre_.size());
  std::fill(centre_.begin(), centre_.end(), Eigen::RowVector2d::Zero());
  std::fill(start_.begin(), start_.end(), Eigen::RowVector2d::Zero());
  for (Pin& pin : pins_) {
    pin.position.setZero();
    for (const int row : pin.rows)
      pin.position += targets.row(row) / (unit_ * static_cast<double>(pin.rows.size()));
    weight[at(pin.part)] += pin.strength;
    // The mean as it grows, lest the sum overflow.
    const double share = pin.strength / weight[at(pin.part)];
    centre_[at(pin.part)] += share * (pin.position - centre_[at(pin.part)]);
    start_[at(pin.part)] += share * (pinned_point(pin, rest_) - start_[at(pin.part)]);
  }
  for (Pin& pin : pins_) pin.position -= centre_[at(pin.part)];
}

/// Step 1 for what the nearest similarity of each part leaves of the targets: similarities cost nothing, and
/// of 100k vertices that are turned as a whole the system alone, being near to singular, loses half of the
/// digits.
void ArapMethod::solve_similar() {
  using Complex = std::complex<double>;
  std::vector<Complex> similarity(centre_.size(), 0.0);
  std::vector<double> size(centre_.size());
  const auto arm = [this](const Pin& pin) {
    return complex_point(pinned_point(pin, rest_) - start_[at(pin.part)]);
  };
  for (const Pin& pin : pins_) {
    similarity[at(pin.part)] += pin.strength * std::conj(arm(pin)) * complex_point(pin.position);
    size[at(pin.part)] += pin.strength * std::norm(arm(pin));
  }
  for (std::size_t part = 0; part < size.size(); ++part) {
    if (determined_[part]) similarity[part] /= size[part];
  }
  Pins left = pins_;
  for (Pin& pin : left) {
    const Complex reached = similarity[at(pin.part)] * arm(pin);
    pin.position -= Eigen::RowVector2d(reached.real(), reached.imag());
  }
  solver_.similar(left, numbers_);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int part = mesh_.part[at(v)];
    if (part >= 0 && determined_[at(part)])
      numbers_[at(v)] += product(similarity[at(part)], complex_point(rest_.row(v) - start_[at(part)]));
  }
}

void ArapMethod::place(Points& x) const {
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int part = mesh_.part[at(v)];
    if (part < 0 || !pinned_[at(part)]) continue;
    const std::complex<double> p = numbers_[at(v)];
    if (determined_[at(part)]) {
      x.row(v) = unit_ * (centre_[at(part)] + Eigen::RowVector2d(p.real(), p.imag()));
    } else {
      x.row(v) = unit_ * (rest_.row(v) + (centre_[at(part)] - start_[at(part)]));
    }
  }
  if (!x.allFinite()) throw SolveError("the shape is not finite: the targets are too far apart");
}

void ArapMethod::two_steps(const Points& targets, Points& x, Points* similar) {
  if (!factored_) {
    solver_.factor(pins_, determined_);
    factored_ = true;
  }
  take_targets(targets);
  solve_similar();
  if (similar != nullptr) place(*similar = x);
  solver_.adjust_scale(pins_, numbers_);
  place(x);
}

void ArapMethod::move(const Points& targets, Points& x, Report& report) {
  if (pins_.empty()) return;
  two_steps(targets, x);
  report.iterations = report.substeps = 1;
}

/// Nothing is left to do after a move.
void ArapMethod::refine(const Points&, Points&, Report&) {}

void ArapMethod::settle(const Points& targets, Points& x, Report& report) {
  move(targets, x, report);
  if (pins_.empty()) return;
  std::vector<std::size_t> free;  // vertices that do not stay where the move has put them
  for (std::size_t v = 0; v < numbers_.size(); ++v) {
    const int part = mesh_.part[v];
    if (part >= 0 && determined_[at(part)]) free.push_back(v);
  }
  const auto take = [&](Eigen::VectorXd& coordinates) {
    coordinates.resize(2 * static_cast<Eigen::Index>(free.size()));
    double* next = coordinates.data();
    for (const std::size_t v : free) {
      *next++ = numbers_[v].real();
      *next++ = numbers_[v].imag();
    }
  };
  const auto give = [&](const Eigen::VectorXd& coordinates) {
    std::fill(numbers_.begin(), numbers_.end(), 0.0);  // the others add the same to each energy
    const double* next = coordinates.data();
    for (const std::size_t v : free) {
      numbers_[v] = {next[0], next[1]};
      next += 2;
    }
  };
  const auto step = [&](const Eigen::VectorXd& from, Eigen::VectorXd& mapped) {
    give(from);
    const double energy = solver_.iterate(pins_, numbers_);
    take(mapped);
    return energy;
  };
  const auto settled = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& mapped) {
    const Eigen::VectorXd way = mapped - from;
    return std::sqrt(way.reshaped(2, way.size() / 2).colwise().squaredNorm().maxCoeff()) <= tolerance * size_;
  };
  Eigen::VectorXd coordinates;
  take(coordinates);
  if (coordinates.size() == 0) return;
  const FixedPointOutcome outcome = accelerate(step, settled, settle_budget, coordinates);
  give(coordinates);
  report.iterations += outcome.iterations;
  report.substeps = report.iterations;
  report.converged = outcome.converged;
  place(x);
}

}  // namespace planar
