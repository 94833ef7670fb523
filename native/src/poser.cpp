// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/poser.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "checks.h"
#include "handle_motion.h"
#include "killing_solver.h"
#include "orientation.h"
#include "spirals.h"
#include "triangle_guard.h"

namespace planar {

namespace {

constexpr double largest_turn = 0.26;    // of an edge in a substep: 15°
constexpr double least_area_left = 0.7;  // of a triangle after a substep
constexpr int substep_budget = 32;       // of a step
constexpr int halving_budget = 8;        // of a substep under which triangles collapse
constexpr int sharing_budget = 10;       // passes over the triangles of such a substep
constexpr int settle_budget = 32;        // steps
constexpr double reached = 1e-3;         // of the box diagonal
constexpr double settled = 1e-6;         // of the box diagonal
constexpr double nearer = 0.99;  // a step of settle() that leaves more of the distance than this is the last

double furthest(const Points& from, const Points& to) {
  return from.rows() == 0 ? 0.0 : (from - to).rowwise().norm().maxCoeff();
}

}  // namespace

struct Poser::State {
  State(Points rest_, Triangles triangles, PoserOptions options_)
      : rest(std::move(rest_)),
        options(std::move(options_)),
        solver(Mesh(rest.rows(), std::move(triangles)), {}),
        spirals(solver.mesh()),
        orientation(rest, solver.mesh().triangles),
        guard(rest, solver.mesh().triangles, options.stiffness),
        positions(rest),
        diagonal((rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm()) {}

  void step(const Points& targets, Report& report);
  bool take_substep(double t);
  void conclude(const Points& targets, Report& report) const;

  Points rest;
  PoserOptions options;
  KillingSolver solver;
  Spirals spirals;
  Orientation orientation;
  TriangleGuard guard;
  Handles handles;
  std::vector<MovingTogether> together;
  Points positions;
  double diagonal;
  std::optional<Points> targets;
  Report report;

  Points current, next, field;  // of the step under way
  Eigen::VectorXd stiffness;
  std::vector<double> area, next_area;
};

/// Moves `current` towards the targets.
void Poser::State::step(const Points& towards, Report& done) {
  ++done.iterations;
  for (int substep = 0; substep < substep_budget; ++substep) {
    const Points velocities = velocities_towards(handles.positions(current), towards, together);
    if (velocities.isZero(0.0)) return;
    guard.stiffness(current, stiffness);
    solver.solve(current, stiffness, velocities, field);
    const double turn = spirals.prepare(current, field);
    double t = std::min(1.0, largest_turn / turn);
    orientation.measure(current, area);
    int halvings = 0;
    while (!take_substep(t)) {
      if (++halvings > halving_budget) return;
      t *= 0.5;
    }
    ++done.substeps;
    std::swap(current, next);
    if (t == 1.0) return;
  }
}

/// Advances `current` by t into `next`; false if triangles collapse that evening out the spirals' factors
/// does not help.
bool Poser::State::take_substep(double t) {
  spirals.advance(t, next);
  if (!next.allFinite()) return false;
  for (int pass = 0; pass < sharing_budget; ++pass) {
    bool collapse = false;
    orientation.measure(next, next_area);
    for (std::size_t i = 0; i < area.size(); ++i) {
      if (area[i] > 0.0 && !(next_area[i] > least_area_left * area[i])) {
        spirals.share(solver.mesh().triangles.data() + 3 * i, next);
        collapse = true;
      }
    }
    if (!collapse) return true;
  }
  return false;
}

void Poser::State::conclude(const Points& towards, Report& done) const {
  done.furthest_handle = furthest(handles.positions(current), towards);
  done.flipped = orientation.count_flipped(current);
  done.converged = done.furthest_handle <= reached * diagonal;
}

Poser::Poser(Points rest, Triangles triangles, PoserOptions options) {
  require_mesh("rest", rest, triangles);
  if (options.pin_weight) require_positive("pin_weight", Eigen::VectorXd::Constant(1, *options.pin_weight));
  require_stiffness(options.stiffness, triangles);
  state_ = std::make_unique<State>(std::move(rest), std::move(triangles), std::move(options));
}

Poser::Poser(Poser&&) noexcept = default;
Poser& Poser::operator=(Poser&&) noexcept = default;
Poser::~Poser() = default;

void Poser::set_handles(Handles handles, Eigen::VectorXd weights, Eigen::VectorXi groups) {
  const double pin_weight = state_->options.pin_weight.value_or(default_pin_weight);
  Eigen::VectorXd strength = Eigen::VectorXd::Constant(handles.size(), pin_weight);
  if (weights.size() != 0) {
    require_rows("weights", weights.size(), handles.size(), "handle");
    require_positive("weights", weights);
    strength.array() *= weights.array();
  }
  std::map<int, std::vector<int>> pins, parts;
  if (groups.size() != 0) {
    require_rows("groups", groups.size(), handles.size(), "handle");
    for (int row = 0; row < static_cast<int>(groups.size()); ++row) pins[groups[row]].push_back(row);
  }
  std::vector<char> patch(static_cast<std::size_t>(handles.size()));
  for (const auto& [label, rows] : pins) {
    if (rows.size() < 2) continue;
    for (const int row : rows) {
      strength[row] /= static_cast<double>(rows.size());
      patch[static_cast<std::size_t>(row)] = 1;
    }
  }
  std::vector<Pin> compiled = state_->solver.compile(handles, strength, patch);

  for (int row = 0; row < static_cast<int>(handles.size()); ++row) {
    parts[state_->solver.mesh().part[static_cast<std::size_t>(handles.vertices(row, 0))]].push_back(row);
  }
  std::vector<MovingTogether> together;
  together.reserve(parts.size() + pins.size());
  for (auto& [part, rows] : parts) together.push_back({std::move(rows), false});
  for (auto& [label, rows] : pins) together.push_back({std::move(rows), true});
  state_->solver.use(std::move(compiled));
  state_->together = std::move(together);
  state_->handles = std::move(handles);
  state_->targets.reset();
}

const Points& Poser::move(const Points& targets) {
  State& state = *state_;
  require_rows("targets", targets.rows(), state.handles.size(), "handle");
  require_finite("targets", targets);
  Report report;
  std::optional<Points> kept = targets;
  state.current = state.positions;
  state.step(targets, report);
  state.conclude(targets, report);
  std::swap(state.positions, state.current);
  std::swap(state.targets, kept);
  state.report = report;
  return state.positions;
}

const Points& Poser::settle() {
  State& state = *state_;
  if (!state.targets) return state.positions;
  const Points& targets = *state.targets;
  Report report;
  state.current = state.positions;
  Points best = state.positions;
  double distance = furthest(state.handles.positions(best), targets);
  for (int i = 0; i < settle_budget && distance > settled * state.diagonal; ++i) {
    state.step(targets, report);
    const double left = furthest(state.handles.positions(state.current), targets);
    if (left < distance) best = state.current;
    if (!(left <= nearer * distance)) break;
    distance = left;
  }
  std::swap(state.current, best);
  state.conclude(targets, report);
  std::swap(state.positions, state.current);
  state.report = report;
  return state.positions;
}

void Poser::reset() {
  State& state = *state_;
  state.positions = state.rest;
  state.targets.reset();
  state.report = {};
}

void Poser::reset(const Points& positions) {
  State& state = *state_;
  require_rows("positions", positions.rows(), state.rest.rows(), "vertex");
  require_finite("positions", positions);
  state.positions = positions;
  state.targets.reset();
  state.report = {};
  state.report.flipped = state.orientation.count_flipped(positions);
}

const Points& Poser::positions() const { return state_->positions; }
const Report& Poser::report() const { return state_->report; }

}  // namespace planar
