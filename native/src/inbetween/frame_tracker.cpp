// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/frame_tracker.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/complex_rows.h"
#include "base/index.h"
#include "energy/rigid_fit.h"
#include "planar/types.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double closeness = 10.0;   // w in units of (diagonal / 50)⁻²
constexpr double hold = 1e-3;        // of w in steps of the energy alone, which does not tell places
constexpr double blocked = 0.5;      // share of a step up to a collapse below which the metric is changed
constexpr double margin = 0.8;       // of the way to a collapse
constexpr double sufficient = 1e-4;  // Armijo
constexpr int most_steps = 100;
constexpr int most_halvings = 30;

std::vector<int> numbered(const Mesh& mesh, SparseSolver& solver) {
  std::vector<int> used, result;
  for (int v = 0; v < mesh.n_vertices; ++v) {
    if (mesh.part[at(v)] >= 0) used.push_back(v);
  }
  for (const int k : solver.fill_reducing_order(vertex_graph(mesh, used))) result.push_back(used[at(k)]);
  return result;
}

double area_of(const Points& x, const Triangles& triangles) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector2d a = x.row(triangles(t, 1)) - x.row(triangles(t, 0));
    const Eigen::RowVector2d b = x.row(triangles(t, 2)) - x.row(triangles(t, 0));
    sum += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

double diagonal_of(const Points& x) { return (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm(); }

}  // namespace

FrameTracker::FrameTracker(const Triangles& triangles, const Points& from, const Points& to)
    : mesh_(from.rows(), triangles),
      parts_(at(mesh_.n_parts), 1),
      solver_(SparseSolver::create(default_backend())),
      matrix_(mesh_, numbered(mesh_, *solver_)),
      orientation_(from, triangles),
      blended_(from, to, triangles),
      diagonal_(std::max(diagonal_of(from), diagonal_of(to))),
      area_of_keys_(0.5 * (area_of(from, triangles) + area_of(to, triangles))),
      energy_(energy_at(0.5)) {
  const auto n_used = mesh_.n_vertices - std::count(mesh_.part.begin(), mesh_.part.end(), -1);
  const double share = area_of_keys_ / static_cast<double>(n_used);
  pull_ = closeness * 2500.0 / (diagonal_ * diagonal_) * share;
  solver_->analyze(matrix_.matrix());
}

PerThread<FrameTracker> FrameTracker::one_a_thread(const ThreadTeam& team, const Triangles& triangles,
                                                   const Points& from, const Points& to) {
  return {team, [=] { return std::make_unique<FrameTracker>(triangles, from, to); }};
}

RestEnergy FrameTracker::energy_at(double u) const {
  return {[&](int t, int v) { return blended_.corner(t, v, u); }, matrix_, orientation_, {}};
}

/// Fills in direction_ by a Newton step, or by one in the Killing metric.
void FrameTracker::solve(bool killing, const Points& x, double pull) {
  double factor = scale_;
  if (killing) {
    matrix_.assemble(x, {}, parts_);
    factor *= 2.0;  // the energy's Hessian is twice K, see HoldMethod
  } else {
    matrix_.set_zero();
    energy_.add_hessian(x, parts_, matrix_);
  }
  for (std::size_t i = 0; i < matrix_.matrix().value.size(); ++i) matrix_.values()[i] *= factor;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (mesh_.part[at(v)] >= 0) matrix_.add(v, v, 2.0 * pull);
  }
  solver_->factorize(matrix_.matrix());
  unknown_.resize(matrix_.matrix().size);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (const int place = matrix_.place(v); place >= 0) {
      unknown_.segment<2>(2 * place) = -gradient_.row(v).transpose();
    }
  }
  solver_->solve(unknown_, unknown_);
  direction_.setZero(mesh_.n_vertices, 2);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int place = matrix_.place(v);
    if (place >= 0) direction_.row(v) = unknown_.segment<2>(2 * place).transpose();
  }
}

bool FrameTracker::keeps_upright(const Points& x) {
  orientation_.measure(x, trial_area_);
  for (std::size_t t = 0; t < area_.size(); ++t) {
    if (area_[t] > 0.0 && !(trial_area_[t] > 0.0)) return false;
  }
  return true;
}

Points FrameTracker::follow(const Points& x, const Points& of, const Points& y, double u, double settled) {
  y_ = y;
  energy_ = energy_at(u);
  scale_ = 4.0 * u * (1.0 - u);
  Points result = predicted(x, of, y);
  minimise(settled, result);
  return result;
}

FrameTracker::Step FrameTracker::step_at(const Points& x, double u) {
  energy_ = energy_at(u);
  scale_ = 1.0;
  Step result;
  result.energy = energy_.gradient(x, gradient_);
  if (!std::isfinite(result.energy)) return result;
  solve(false, x, hold * pull_);
  result.collapse = energy_.first_collapse(x, direction_);
  result.slope = gradient_.cwiseProduct(direction_).sum();
  result.direction = direction_;
  return result;
}

void FrameTracker::minimise(double settled, Points& x) {
  orientation_.measure(x, area_);
  for (int step = 0; step < most_steps; ++step) {
    const double start = scale_ * energy_.gradient(x, gradient_) + pull_ * (x - y_).squaredNorm();
    gradient_ = scale_ * gradient_ + 2.0 * pull_ * (x - y_);
    if (!std::isfinite(start)) throw SolveError("a frame cannot be kept from flipping");
    solve(false, x, pull_);
    double collapse = energy_.first_collapse(x, direction_);
    const bool newton = collapse >= blocked;
    if (!newton) {
      solve(true, x, pull_);
      collapse = energy_.first_collapse(x, direction_);
    }
    const double longest = direction_.rowwise().norm().maxCoeff();
    const double slope = gradient_.cwiseProduct(direction_).sum();
    double t = std::min(1.0, margin * collapse);
    for (int halvings = 0;; t *= 0.5, ++halvings) {
      if (halvings == most_halvings) return;
      trial_ = x + t * direction_;
      if (value(trial_) <= start + sufficient * t * slope + 1e-13 * std::abs(start) &&
          keeps_upright(trial_)) {
        break;
      }
    }
    std::swap(x, trial_);
    if (newton && t == 1.0 && longest < settled * diagonal_) return;
  }
}

/// Where to start for y from the solution x of a frame `of` near to it: moved as from `of` to y, rigidly
/// where more would collapse a triangle. Vertices of other parts are y's.
Points FrameTracker::predicted(const Points& x, const Points& of, const Points& y) const {
  const auto for_vertices = [&](const auto& visit) {
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (mesh_.part[at(v)] >= 0) visit(v, mesh_.part[at(v)]);
    }
  };
  std::vector<PointPair> pairs;
  for_vertices([&](int v, int part) { pairs.push_back({part, 1.0, complex_row(of, v), complex_row(y, v)}); });
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, pairs);
  Points result = y, bending = Points::Zero(y.rows(), 2);
  for_vertices([&](int v, int part) {
    const RigidMotion& motion = motions[at(part)];
    const Complex p = motion.at(complex_row(x, v));
    const Complex left = motion.left(complex_row(of, v), complex_row(y, v));
    result.row(v) << p.real(), p.imag();
    bending.row(v) << left.real(), left.imag();
  });
  const double collapse = energy_.first_collapse(result, bending);
  // Near to a collapse the barrier is steep: better well away from it.
  if (collapse > 2.0) result += bending;
  return result;
}

}  // namespace planar
