// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/poser.h"

#include <cmath>
#include <map>
#include <utility>

#include "base/checks.h"
#include "base/index.h"
#include "mesh/orientation.h"
#include "mesh/triangle_shape.h"
#include "posing/akvf_method.h"
#include "posing/arap_method.h"
#include "posing/cage_method.h"
#include "posing/hold_method.h"
#include "posing/posing_method.h"

namespace planar {

namespace {

/// What positions are relative to while they are worked on, so that they have the same digits wherever the
/// rest lies: near its middle, and a multiple of a power of two above its size. Taking that off costs hardly
/// a digit, and nothing where the rest lies about the origin: there it is 0.
Eigen::RowVector2d centre_of(const Points& rest) {
  const Eigen::RowVector2d lowest = rest.colwise().minCoeff(), highest = rest.colwise().maxCoeff();
  int exponent = 0;
  std::frexp((highest - lowest).maxCoeff(), &exponent);
  const double unit = std::ldexp(1.0, exponent);
  const auto along = [&](int axis) {
    const double middle = 0.5 * lowest[axis] + 0.5 * highest[axis];
    const double result = unit * std::round(middle / unit);
    return std::isfinite(result) ? result : middle;
  };
  return {along(0), along(1)};
}

Points moved(const Points& x, const Eigen::RowVector2d& way) { return x.rowwise() + way; }

/// What a move keeps of a shape that no cage can have. Hold lets go of it, but not at once, which would be
/// seen; akvf has nothing else to go by; arap never asks where the mesh was.
double kept_beside_cage(PoserMethod method) {
  if (method == PoserMethod::hold) return 0.5;
  return method == PoserMethod::akvf ? 1.0 : 0.0;
}

std::unique_ptr<PosingMethod> make_method(const Points& rest, const Triangles& triangles,
                                          const Eigen::RowVector2d& centre, const Orientation& orientation,
                                          const PoserOptions& options) {
  const auto make = [method = options.method](
                        const Points& x, const Triangles& t, const Orientation& o,
                        const Eigen::VectorXd& stiffness) -> std::unique_ptr<PosingMethod> {
    if (method == PoserMethod::hold) return std::make_unique<HoldMethod>(x, t, o, stiffness);
    if (method == PoserMethod::arap)
      return std::make_unique<ArapMethod>(x, t, stiffness, ArapWeights::cotangent);
    return std::make_unique<AkvfMethod>(x, t, o, stiffness);
  };
  if (options.cage) {
    if (std::optional<Coarse> coarse = coarse_for_cage(rest, triangles, *options.cage, options.progress)) {
      return std::make_unique<CageMethod>(std::move(*coarse), rest, centre, orientation, options.stiffness,
                                          kept_beside_cage(options.method), make);
    }
  }
  return make(rest, triangles, orientation, options.stiffness);
}

}  // namespace

struct Poser::State {
  State(Points rest_, const Triangles& triangles, const PoserOptions& options)
      : rest(std::move(rest_)),
        pin_weight(options.pin_weight.value_or(default_pin_weight)),
        centre(centre_of(rest)),
        orientation(rest, triangles, flat_triangles(rest, triangles), centre),
        x(moved(rest, -centre)),
        method(make_method(x, triangles, centre, orientation, options)),
        positions(rest) {}

  using Action = void (PosingMethod::*)(const Points& targets, Points& x, Report& report);
  void act(Action action, Points towards, const std::function<bool(double)>& progress = {});

  Points rest;
  double pin_weight;
  Eigen::RowVector2d centre;
  Orientation orientation;
  Points x;  ///< positions, relative to the centre
  std::unique_ptr<PosingMethod> method;
  Handles handles;
  Points positions;
  std::optional<Points> targets;  ///< relative to the centre
  Report report;
  Points next;  ///< x under way
};

void Poser::State::act(Action action, Points towards, const std::function<bool(double)>& progress) {
  Report done;
  next = x;
  method->set_progress(progress);
  (method.get()->*action)(towards, next, done);
  if (towards.rows() != 0) {
    done.furthest_handle = (handles.positions(next) - towards).rowwise().norm().maxCoeff();
  }
  if (!method->counts_flipped()) done.flipped = orientation.count_flipped(next);
  // What stays where it is does so to the bit.
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    if (next.row(v) != x.row(v)) positions.row(v) = next.row(v) + centre;
  }
  std::swap(x, next);
  targets = std::move(towards);
  report = done;
}

Poser::Poser(Points rest, const Triangles& triangles, const PoserOptions& options) {
  require_mesh("rest", rest, triangles);
  require_triangles(rest.rows(), triangles);
  if (options.pin_weight) require_positive("pin_weight", Eigen::VectorXd::Constant(1, *options.pin_weight));
  require_stiffness(options.stiffness, triangles);
  require_cage(options.cage);
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
  set.patch.resize(at(n_handles));
  for (auto& [label, rows] : pins) {
    if (rows.size() < 2) continue;
    for (const int row : rows) {
      set.strength[row] /= static_cast<double>(rows.size());
      set.patch[at(row)] = 1;
    }
    set.patches.push_back(std::move(rows));
  }
  state_->method->set_handles(set);
  state_->handles = std::move(set.handles);
  state_->targets.reset();
}

void Poser::set_joints(const Handles& first, const Handles& second, const Eigen::VectorXd& strength) {
  require_rows("second", second.size(), first.size(), "point of first");
  JointSet set{first, second, Eigen::VectorXd::Constant(first.size(), joint_weight)};
  if (strength.size() != 0) {
    require_rows("strength", strength.size(), first.size(), "joint");
    require_positive("strength", strength);
    set.strength.array() *= strength.array();
  }
  state_->method->set_joints(set);
  state_->targets.reset();
}

const Points& Poser::move(const Points& targets) {
  require_rows("targets", targets.rows(), state_->handles.size(), "handle");
  require_finite("targets", targets);
  state_->act(&PosingMethod::move, moved(targets, -state_->centre));
  return state_->positions;
}

const Points& Poser::refine(const std::function<bool(double)>& progress) {
  if (state_->targets) state_->act(&PosingMethod::refine, *state_->targets, progress);
  return state_->positions;
}

const Points& Poser::settle(const std::function<bool(double)>& progress) {
  if (state_->targets) state_->act(&PosingMethod::settle, *state_->targets, progress);
  return state_->positions;
}

void Poser::reset() { reset(state_->rest); }

void Poser::reset(const Points& positions) {
  State& state = *state_;
  require_rows("positions", positions.rows(), state.rest.rows(), "vertex");
  require_finite("positions", positions);
  state.x = moved(positions, -state.centre);
  state.positions = positions;
  state.targets.reset();
  state.report = {};
  state.report.flipped = state.orientation.count_flipped(state.x);
  state.method->reset();
}

const Points& Poser::positions() const { return state_->positions; }
const Report& Poser::report() const { return state_->report; }

}  // namespace planar
