// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/poser.h"

#include <map>
#include <utility>

#include "base/checks.h"
#include "mesh/orientation.h"
#include "posing/akvf_method.h"
#include "posing/hold_method.h"
#include "posing/posing_method.h"

namespace planar {

namespace {

std::unique_ptr<PosingMethod> make_method(const Points& rest, const Triangles& triangles,
                                          const PoserOptions& options) {
  if (options.method == PoserMethod::hold)
    return std::make_unique<HoldMethod>(rest, triangles, options.stiffness);
  return std::make_unique<AkvfMethod>(rest, triangles, options.stiffness);
}

}  // namespace

struct Poser::State {
  State(Points rest_, const Triangles& triangles, const PoserOptions& options)
      : rest(std::move(rest_)),
        pin_weight(options.pin_weight.value_or(default_pin_weight)),
        method(make_method(rest, triangles, options)),
        orientation(rest, triangles),
        positions(rest) {}

  using Action = void (PosingMethod::*)(const Points& targets, Points& x, Report& report);
  void act(Action action, Points towards);

  Points rest;
  double pin_weight;
  std::unique_ptr<PosingMethod> method;  ///< checks the triangles, hence comes first
  Orientation orientation;
  Handles handles;
  Points positions;
  std::optional<Points> targets;
  Report report;
  Points next;  ///< positions under way
};

void Poser::State::act(Action action, Points towards) {
  Report done;
  next = positions;
  (method.get()->*action)(towards, next, done);
  if (towards.rows() != 0) {
    done.furthest_handle = (handles.positions(next) - towards).rowwise().norm().maxCoeff();
  }
  done.flipped = orientation.count_flipped(next);
  std::swap(positions, next);
  targets = std::move(towards);
  report = done;
}

Poser::Poser(Points rest, const Triangles& triangles, const PoserOptions& options) {
  require_mesh("rest", rest, triangles);
  if (options.pin_weight) require_positive("pin_weight", Eigen::VectorXd::Constant(1, *options.pin_weight));
  require_stiffness(options.stiffness, triangles);
  state_ = std::make_unique<State>(std::move(rest), triangles, options);
}

Poser::Poser(Poser&&) noexcept = default;
Poser& Poser::operator=(Poser&&) noexcept = default;
Poser::~Poser() = default;

void Poser::set_handles(Handles handles, Eigen::VectorXd weights, Eigen::VectorXi groups) {
  HandleSet set{std::move(handles), {}, {}, {}};
  const Eigen::Index n_handles = set.handles.size();
  set.strength.setConstant(n_handles, state_->pin_weight);
  if (weights.size() != 0) {
    require_rows("weights", weights.size(), n_handles, "handle");
    require_positive("weights", weights);
    set.strength.array() *= weights.array();
  }
  std::map<int, std::vector<int>> pins;
  if (groups.size() != 0) {
    require_rows("groups", groups.size(), n_handles, "handle");
    for (int row = 0; row < static_cast<int>(n_handles); ++row) pins[groups[row]].push_back(row);
  }
  set.patch.resize(static_cast<std::size_t>(n_handles));
  for (auto& [label, rows] : pins) {
    if (rows.size() < 2) continue;
    for (const int row : rows) {
      set.strength[row] /= static_cast<double>(rows.size());
      set.patch[static_cast<std::size_t>(row)] = 1;
    }
    set.patches.push_back(std::move(rows));
  }
  state_->method->set_handles(set);
  state_->handles = std::move(set.handles);
  state_->targets.reset();
}

const Points& Poser::move(const Points& targets) {
  require_rows("targets", targets.rows(), state_->handles.size(), "handle");
  require_finite("targets", targets);
  state_->act(&PosingMethod::move, targets);
  return state_->positions;
}

const Points& Poser::refine() {
  if (state_->targets) state_->act(&PosingMethod::refine, *state_->targets);
  return state_->positions;
}

const Points& Poser::settle() {
  if (state_->targets) state_->act(&PosingMethod::settle, *state_->targets);
  return state_->positions;
}

void Poser::reset() { reset(state_->rest); }

void Poser::reset(const Points& positions) {
  State& state = *state_;
  require_rows("positions", positions.rows(), state.rest.rows(), "vertex");
  require_finite("positions", positions);
  state.positions = positions;
  state.targets.reset();
  state.report = {};
  state.report.flipped = state.orientation.count_flipped(positions);
  state.method->reset();
}

const Points& Poser::positions() const { return state_->positions; }
const Report& Poser::report() const { return state_->report; }

}  // namespace planar
