// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/akvf_method.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/diameter.h"
#include "base/index.h"

namespace planar {

namespace {

constexpr double largest_turn = 0.26;    // of an edge in a substep: 15°
constexpr double least_area_left = 0.7;  // of a triangle after a substep
constexpr int substep_budget = 32;       // of a step
constexpr int halving_budget = 8;        // of a substep under which triangles collapse
constexpr int carrying_budget = 64;      // of a way on which float32 cannot keep the triangles apart
constexpr int sharing_budget = 10;       // passes over the triangles of such a substep
constexpr int settle_budget = 32;        // steps
constexpr double reached = 1e-3;         // of the rest's diameter
constexpr double tolerance = 1e-6;       // of the rest's diameter
constexpr double nearer = 0.99;  // a step of settle() that leaves more of the distance than this is the last
constexpr double least_straight = 0.85;  // 1/|φ(z)| at |z| = largest_turn, at least

constexpr double unlimited = std::numeric_limits<double>::infinity();

}  // namespace

AkvfMethod::AkvfMethod(const Points& rest, Triangles triangles, const Orientation& orientation,
                       const Eigen::VectorXd& stiffness)
    : size_(diameter(rest)),
      solver_(Mesh(rest.rows(), std::move(triangles)), {}),
      spirals_(solver_.mesh()),
      orientation_(orientation),
      guard_(rest, solver_.mesh().triangles, orientation.flat(), stiffness) {}

void AkvfMethod::set_handles(const HandleSet& set) {
  std::vector<Pin> compiled = solver_.compile(set.handles, set.strength, set.patch);
  Handles handles = set.handles;
  std::vector<std::vector<int>> part_rows(at(solver_.mesh().n_parts));
  for (const Pin& pin : compiled) {
    std::vector<int>& rows = part_rows[at(pin.part)];
    rows.insert(rows.end(), pin.rows.begin(), pin.rows.end());
  }
  std::vector<MovingTogether> together;
  together.reserve(part_rows.size() + set.patches.size());
  for (const auto& rows : part_rows) together.push_back({rows, false});
  for (const auto& rows : set.patches) together.push_back({rows, true});
  solver_.use(std::move(compiled));
  part_rows_ = std::move(part_rows);
  together_ = std::move(together);
  handles_ = std::move(handles);
}

void AkvfMethod::move(const Points& targets, Points& x, Report& report) {
  step(targets, x, report);
  report.converged = furthest(x, targets) <= reached * size_;
}

void AkvfMethod::refine(const Points& targets, Points& x, Report& report) {
  ++report.iterations;
  substep(targets, x, refine_limit * size_, report);
  report.converged = furthest(x, targets) <= reached * size_;
}

void AkvfMethod::settle(const Points& targets, Points& x, Report& report) {
  Points best = x;
  double distance = furthest(best, targets);
  for (int i = 0; i < settle_budget && distance > tolerance * size_; ++i) {
    step(targets, x, report);
    const double left = furthest(x, targets);
    if (left < distance) best = x;
    if (!(left <= nearer * distance)) break;
    distance = left;
  }
  std::swap(x, best);
  report.converged = furthest(x, targets) <= reached * size_;
}

/// Moves x towards the targets.
void AkvfMethod::step(const Points& targets, Points& x, Report& report) {
  ++report.iterations;
  carry(targets, x, report);
  for (int i = 0; i < substep_budget; ++i) {
    if (!substep(targets, x, unlimited, report)) return;
  }
}

/// Takes the parts that are to go further than the rest is large straight to the middle of their targets, or
/// as near to it as float32 allows.
void AkvfMethod::carry(const Points& targets, Points& x, Report& report) {
  const Points left = targets - handles_.positions(x);
  std::vector<Eigen::RowVector2d> way(part_rows_.size(), Eigen::RowVector2d::Zero());
  bool far = false;
  for (std::size_t part = 0; part < way.size(); ++part) {
    Eigen::RowVector2d mean = Eigen::RowVector2d::Zero();
    for (const int row : part_rows_[part])
      mean += left.row(row) / static_cast<double>(part_rows_[part].size());
    if (!(mean.norm() > size_)) continue;
    way[part] = mean;
    far = true;
  }
  if (!far) return;
  orientation_.measure(x, upright_);
  double share = 1.0;
  for (int halvings = 0; halvings <= carrying_budget; ++halvings, share *= 0.5) {
    next_ = x;
    for (int v = 0; v < solver_.mesh().n_vertices; ++v) {
      const int part = solver_.mesh().part[at(v)];
      if (part >= 0) next_.row(v) += share * way[at(part)];
    }
    if (!keeps_upright(next_)) continue;
    std::swap(x, next_);
    ++report.substeps;
    return;
  }
}

/// Moves x towards the targets, no vertex by more than `limit`; false if nothing is left to do.
bool AkvfMethod::substep(const Points& targets, Points& x, double limit, Report& report) {
  const Points velocities = velocities_towards(handles_.positions(x), targets, together_);
  if (velocities.isZero(0.0)) return false;
  if (!solver_.is_prepared(x)) prepare(x);
  solver_.solve(velocities, field_);
  const double turn = spirals_.prepare(x, field_);
  const double fastest = field_.rowwise().norm().maxCoeff();
  double t = std::min({1.0, largest_turn / turn, least_straight * limit / fastest});
  orientation_.measure(x, upright_);
  orientation_.measure_exactly(x, area_);
  int halvings = 0;
  while (!advance(t)) {
    if (++halvings > halving_budget) return false;
    t *= 0.5;
  }
  ++report.substeps;
  std::swap(x, next_);
  prepare(x);
  return t < 1.0;
}

/// Has the systems at x factored while the caller goes on: whatever comes next, it starts from there.
void AkvfMethod::prepare(const Points& x) {
  guard_.stiffness(x, stiffness_);
  solver_.prepare(x, stiffness_);
}

/// Advances the prepared spirals by t into `next_`; false if triangles collapse that evening out the spirals'
/// factors does not help.
bool AkvfMethod::advance(double t) {
  spirals_.advance(t, next_);
  if (!next_.allFinite()) return false;
  for (int pass = 0; pass < sharing_budget; ++pass) {
    bool collapse = false;
    orientation_.measure(next_, next_upright_);
    orientation_.measure_exactly(next_, next_area_);
    for (std::size_t i = 0; i < area_.size(); ++i) {
      if (upright_[i] > 0.0 && !(next_upright_[i] > 0.0 && next_area_[i] > least_area_left * area_[i])) {
        spirals_.share(solver_.mesh().triangles.data() + 3 * i, next_);
        collapse = true;
      }
    }
    if (!collapse) return true;
  }
  return false;
}

/// No triangle that lay as at rest at the last x that was measured does so no longer, as float32.
bool AkvfMethod::keeps_upright(const Points& x) {
  orientation_.measure(x, next_upright_);
  for (std::size_t i = 0; i < upright_.size(); ++i) {
    if (upright_[i] > 0.0 && !(next_upright_[i] > 0.0)) return false;
  }
  return true;
}

double AkvfMethod::furthest(const Points& x, const Points& targets) const {
  return targets.rows() == 0 ? 0.0 : (handles_.positions(x) - targets).rowwise().norm().maxCoeff();
}

}  // namespace planar
