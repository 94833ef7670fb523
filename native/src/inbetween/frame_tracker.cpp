// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/frame_tracker.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/complex_rows.h"
#include "base/diameter.h"
#include "base/index.h"
#include "energy/rigid_fit.h"
#include "mesh/triangle_shape.h"
#include "planar/types.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double closeness = 10.0;  // w in units of (size / 50)⁻²
constexpr double hold = 1e-3;       // of w in steps of the energy alone, which does not tell places
constexpr int most_steps = 100;
constexpr int most_factors = 300;  // as many as that may want

double area_of(const Points& x, const Triangles& triangles) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    sum += 0.5 * std::abs(doubled_area(x, triangles.data() + 3 * t));
  }
  return sum;
}

}  // namespace

FrameTracker::FrameTracker(const Triangles& triangles, const Points& from, const Points& to)
    : mesh_(from.rows(), triangles),
      blended_(from, to, triangles),
      orientation_(from, triangles, blended_.flat()),
      area_of_keys_(0.5 * (area_of(from, triangles) + area_of(to, triangles))),
      springs_(mesh_),
      newton_(mesh_, springs_, {}, orientation_, std::max(diameter(from), diameter(to))) {
  const auto n_used = mesh_.n_vertices - std::count(mesh_.part.begin(), mesh_.part.end(), -1);
  const double share = area_of_keys_ / static_cast<double>(n_used);
  pull_ = closeness * 2500.0 / (newton_.size() * newton_.size()) * share;
}

double FrameTracker::Pull::value(const Points& x, Points* gradient) const {
  if (gradient != nullptr) *gradient += 2.0 * strength * (x - y);
  return strength * (x - y).squaredNorm();
}

void FrameTracker::Pull::add_hessian(MeshMatrix& matrix, double scale) const {
  for (int v = 0; v < mesh.n_vertices; ++v) {
    if (mesh.part[at(v)] >= 0) matrix.add(v, v, 2.0 * scale * strength);
  }
}

PerThread<FrameTracker> FrameTracker::one_a_thread(const ThreadTeam& team, const Triangles& triangles,
                                                   const Points& from, const Points& to) {
  return {team, [=] { return std::make_unique<FrameTracker>(triangles, from, to); }};
}

RestEnergy FrameTracker::energy_at(double u) {
  return {
      [&](int t, int v) { return blended_.corner(t, v, u); }, newton_.system().matrix(), blended_.flat(), {}};
}

Points FrameTracker::follow(const Points& x, const Points& of, const Points& y, double u, double tolerance) {
  springs_.y = y;
  springs_.strength = pull_;
  newton_.forget();
  newton_.set_energy(energy_at(u), 4.0 * u * (1.0 - u));
  Points result = predicted(x, of, y);
  newton_.begin(result);
  constexpr double anywhere = std::numeric_limits<double>::infinity();
  const Newton::Budget budget{most_steps, most_factors, false, anywhere, tolerance * newton_.size()};
  try {
    converged_ = newton_.descend(budget, result).converged;
  } catch (const SolveError&) {  // how far it got is upright; one frame refuses no motion
    converged_ = false;
  }
  return result;
}

FrameTracker::Step FrameTracker::step_at(const Points& x, double u) {
  springs_.y = x;
  springs_.strength = hold * pull_;
  newton_.set_energy(energy_at(u), 1.0);
  Step result;
  const Newton::Step step = newton_.step_at(x, result.direction);
  result.collapse = step.collapse;
  result.energy = step.value;
  result.slope = step.slope;
  return result;
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
  const double collapse = newton_.rest_energy().first_collapse(result, bending);
  // Near to a collapse the barrier is steep: better well away from it.
  if (collapse > 2.0) result += bending;
  return result;
}

}  // namespace planar
