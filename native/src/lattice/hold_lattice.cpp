// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/hold_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/index.h"
#include "energy/newton.h"
#include "mesh/triangle_shape.h"

namespace planar {

namespace {

constexpr int hessian_parts = 4;  // of a cell along each axis
constexpr int sample_parts = 6;
constexpr double worth_sampling = 0.5;  // of the triangles: more samples are not worth it
constexpr int move_budget = 2;
constexpr int settle_budget = 200;
constexpr int halving_budget = 30;
constexpr double margin = 0.8;        // of the way to the first collapse
constexpr double blocked = 1.25;      // a collapse before this t: samples do not tell enough
constexpr double hot = 12.0;          // |J|² + |J⁻¹|² - 4 of triangles that join the samples then
constexpr double settled = 1e-6;      // of the size: a full step after which nothing is left to do
constexpr double negligible = 1e-10;  // of the size: a step not worth taking
constexpr double rounding = 1e-13;    // of the energy, and of the area: what its evaluation may be off by

constexpr double infinity = std::numeric_limits<double>::infinity();

SubCells cells_of(const Points& rest, const HeldShape& shape, const LatticeFrame& frame, int parts) {
  const auto n = static_cast<Eigen::Index>(shape.triangles().size());
  Coordinates middle(n, 2);
  Eigen::VectorXd area(n);
  for (Eigen::Index t = 0; t < n; ++t) {
    const HeldShape::Triangle& triangle = shape.triangles()[at(t)];
    const auto& v = triangle.vertex;
    middle.row(t) = (rest.row(v[0]) + rest.row(v[1]) + rest.row(v[2])) / 3.0;
    area[t] = triangle.area;
  }
  return {frame.in_steps(middle), area, parts};
}

}  // namespace

HoldLattice::HoldLattice(const Points& rest, const Triangles& triangles, const LatticeWeights& weights,
                         const Points& lattice_rest, double size, double shape_weight, double smooth)
    : HoldLattice(rest, triangles, weights, lattice_rest, LatticeFrame(lattice_rest), size, shape_weight,
                  smooth) {}

HoldLattice::HoldLattice(const Points& rest, const Triangles& triangles, const LatticeWeights& weights,
                         const Points& lattice_rest, const LatticeFrame& frame, double size,
                         double shape_weight, double smooth)
    : rest_(rest),
      weights_(weights),
      lattice_rest_(lattice_rest),
      size_(size),
      shape_weight_(shape_weight),
      orientation_(rest, triangles, flat_triangles(rest, triangles)),
      shape_(rest, triangles, orientation_.flat()),
      system_(weights, shape_, cells_of(rest, shape_, frame, hessian_parts),
              second_differences(frame.count()), smooth),
      samples_(weights) {
  const SubCells cells = cells_of(rest, shape_, frame, sample_parts);
  const double n_triangles = static_cast<double>(shape_.triangles().size());
  if (static_cast<double>(cells.middle.size()) > worth_sampling * n_triangles) return;
  for (std::size_t c = 0; c < cells.middle.size(); ++c) {
    samples_.add(shape_.triangles()[at(cells.middle[c])], cells.middle[c], cells.measure[c]);
  }
  n_samples_ = samples_.size();
}

double HoldLattice::value(const LatticeSprings<2>& springs, Over over, const Points& d,
                          const Points& u) const {
  const double shape = over == Over::samples ? samples_.value(d, nullptr) : shape_.value(u);
  return shape_weight_ * shape + system_.smoothness(d, nullptr) + springs.value(d, nullptr);
}

/// Fills in gradient_; the value.
double HoldLattice::gradient(const LatticeSprings<2>& springs, Over over, const Points& d, const Points& u) {
  gradient_.setZero(d.rows(), 2);
  double shape = 0.0;
  if (over == Over::samples) {
    shape = samples_.value(d, &gradient_);
  } else {
    shape = shape_.gradient(u, vertex_gradient_);
    add_transposed<2>(weights_, vertex_gradient_, gradient_);
  }
  gradient_ *= shape_weight_;
  return shape_weight_ * shape + system_.smoothness(d, &gradient_) + springs.value(d, &gradient_);
}

/// Triangles that float32 has without area or the other way round.
int HoldLattice::lying_wrong(const Points& u) {
  // Rounded here, once for all triangles that a vertex has.
  positions_.resize(u.rows(), 2);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    positions_.data()[i] = static_cast<double>(static_cast<float>(rest_.data()[i] + u.data()[i]));
  }
  orientation_.measure_exactly(positions_, areas_);
  return static_cast<int>(std::count_if(areas_.begin(), areas_.end(), [](double a) { return !(a > 0.0); }));
}

HoldLattice::Outcome HoldLattice::move(const LatticeSprings<2>& springs, LatticePose<2>& pose) {
  const Over over = n_samples_ > 0 ? Over::samples : Over::triangles;
  samples_.shorten(n_samples_);
  // The lowest of the states to begin at, none with a triangle turned over; the pose itself wins a draw.
  std::vector<Points> states = starts<2>(springs, lattice_rest_, pose.d);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (over == Over::triangles && i > 0) product<2>(weights_, states[i], trial_u_);
    const double energy = value(springs, over, states[i], i > 0 ? trial_u_ : pose.u);
    order.emplace_back(std::isfinite(energy) ? energy : infinity, i);
  }
  std::stable_sort(order.begin(), order.end());
  for (const auto& [energy, i] : order) {
    if (energy == infinity) break;
    if (i == 0) {
      if (pose.wrong == 0 || shape_.is_upright(pose.u)) return descend(springs, over, move_budget, pose);
      continue;
    }
    LatticePose<2> other;
    other.d = std::move(states[i]);
    product<2>(weights_, other.d, other.u);
    if (!shape_.is_upright(other.u)) continue;
    other.wrong = lying_wrong(other.u);
    pose = std::move(other);
    return descend(springs, over, move_budget, pose);
  }
  throw SolveError(
      "no state to begin at: the targets are too far away, or locked points turn triangles over");
}

HoldLattice::Outcome HoldLattice::refine(const LatticeSprings<2>& springs, LatticePose<2>& pose) {
  return descend(springs, Over::triangles, move_budget, pose);
}

HoldLattice::Outcome HoldLattice::settle(const LatticeSprings<2>& springs, LatticePose<2>& pose) {
  return descend(springs, Over::triangles, settle_budget, pose);
}

HoldLattice::Outcome HoldLattice::descend(const LatticeSprings<2>& springs, Over over, int budget,
                                          LatticePose<2>& pose) {
  Outcome outcome;
  while (outcome.iterations < budget) {
    double energy = gradient(springs, over, pose.d, pose.u);
    if (!std::isfinite(energy) || !gradient_.allFinite()) {
      throw SolveError("the energy is not finite: the targets are too far away");
    }
    if (over == Over::samples) {
      system_.factorize(samples_, pose.d, shape_weight_);
    } else {
      system_.factorize(pose.u, shape_weight_);
    }
    system_.solve(gradient_, step_);
    product<2>(weights_, step_, du_);
    const double length = std::sqrt(du_.rowwise().squaredNorm().maxCoeff());
    if (!std::isfinite(length)) throw SolveError("the step is not finite: the targets are too far away");
    if (length <= negligible * size_) {
      outcome.converged = over == Over::triangles;
      return outcome;
    }
    ++outcome.iterations;
    const HeldShape::Collapse collapse = shape_.first_collapse(pose.u, du_);
    const double furthest = std::min(1.0, margin * collapse.t);
    if (over == Over::samples && collapse.t < blocked) {
      join(pose.u, furthest, collapse.triangle);
      energy = value(springs, over, pose.d, pose.u);
    }
    const double t = search(springs, over, energy, furthest, pose);
    if (length <= settled * size_ && (t == 0.0 || t == 1.0)) {
      outcome.converged = over == Over::triangles;
      return outcome;
    }
    if (t == 0.0) return outcome;
  }
  return outcome;
}

/// Moves the pose along the step by Armijo's rule, at most `furthest` of it; by how much.
double HoldLattice::search(const LatticeSprings<2>& springs, Over over, double value_before, double furthest,
                           LatticePose<2>& pose) {
  const double slope = gradient_.cwiseProduct(step_).sum();
  const double error = rounding * (std::abs(value_before) + shape_weight_ * shape_.area());
  double t = furthest;
  for (int halvings = 0; halvings <= halving_budget; ++halvings, t *= 0.5) {
    trial_d_ = pose.d + t * step_;
    trial_u_ = pose.u + t * du_;
    const double reached = value(springs, over, trial_d_, trial_u_);
    if (!Newton::lessens(value_before, reached, t, slope, error)) continue;
    const int wrong = lying_wrong(trial_u_);
    if (wrong > pose.wrong) continue;
    std::swap(pose.d, trial_d_);
    std::swap(pose.u, trial_u_);
    pose.wrong = wrong;
    return t;
  }
  return 0.0;
}

/// Takes the triangles that are badly distorted t along the step, and the one that blocks it, among the
/// samples.
void HoldLattice::join(const Points& u, double t, int blocking) {
  std::vector<char> known(shape_.triangles().size(), 0);
  for (std::size_t i = 0; i < samples_.size(); ++i) known[at(samples_.triangle(i))] = 1;
  trial_u_ = u + t * du_;
  for (std::size_t n = 0; n < shape_.triangles().size(); ++n) {
    const HeldShape::Triangle& triangle = shape_.triangles()[n];
    const int number = static_cast<int>(n);
    if (known[n] || (number != blocking && !(triangle.jacobian(trial_u_).value() > hot))) continue;
    samples_.add(triangle, number, triangle.area);
  }
}

}  // namespace planar
