// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/flatten.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/checks.h"
#include "base/complex_rows.h"
#include "base/index.h"
#include "flatten/patch.h"
#include "flatten/placing.h"
#include "flatten/tutte_map.h"
#include "flatten/two_steps.h"
#include "mesh/orientation.h"
#include "posing/hold_method.h"

namespace planar {

namespace {

constexpr int most_steps = 400;      // to lay a surface flat
constexpr double still_to_do = 0.9;  // of the work that was left, after a step: most take 3 to 30

/// Numbers of about 1 in place of the caller's, exactly: about the middle, and over a power of two.
struct Unit {
  explicit Unit(const SpacePoints& vertices) : size(1.0) {
    const double largest = vertices.size() > 0 ? vertices.cwiseAbs().maxCoeff() : 0.0;
    if (!(largest > 0.0 && std::isfinite(largest))) return;
    size = std::ldexp(1.0, std::ilogb(largest));
    const SpacePoints small = vertices / size;
    const Eigen::RowVector3d lowest = small.colwise().minCoeff(), highest = small.colwise().maxCoeff();
    const double extent = (highest - lowest).maxCoeff();
    if (!(extent > 0.0)) return;
    middle = 0.5 * (lowest + highest);
    finer = std::ldexp(1.0, std::ilogb(extent));
  }

  SpacePoints of(const SpacePoints& vertices) const { return ((vertices / size).rowwise() - middle) / finer; }
  Points of(const Points& x) const { return x / size / finer; }
  Points back(const Points& x) const { return x * finer * size; }

  double size, finer = 1.0;  ///< their product is the unit; it alone might not be a number
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
};

std::array<int, 2> checked_edge(const Patch& patch, const std::optional<std::array<int, 2>>& fixed) {
  if (!fixed) return patch.central_edge();
  for (const int end : {0, 1})
    require_index("fixed", end, "vertex", (*fixed)[at(end)], patch.mesh.n_vertices);
  const int edge = patch.mesh.find_edge((*fixed)[0], (*fixed)[1]);
  if (edge < 0) throw std::invalid_argument("fixed: its vertices share no edge");
  if (!(patch.length[at(edge)] > 0.0)) throw std::invalid_argument("fixed: its edge has no length");
  return *fixed;
}

void require_options(const FlattenOptions& options) {
  require_positive("pin_weight", Eigen::VectorXd::Constant(1, options.pin_weight));
  if (options.iterations < 0) throw std::invalid_argument("iterations must be at least 0");
}

}  // namespace

struct Flattener::State {
  State(const SpacePoints& vertices, const Triangles& triangles, const FlattenOptions& options);

  void descend(const FlattenOptions& options);
  bool upright(const Points& at_x);
  void tell(const FlattenOptions& options, double share) const {
    if (options.progress && !options.progress(share)) throw Cancelled();
  }
  HoldMethod& hold();
  double furthest(const Points& at_x, const Points& towards) const;
  using Action = void (PosingMethod::*)(const Points& targets, Points& x, Report& report);
  void act(Action action, Points towards);

  Unit unit;
  Patch patch;
  double pin_weight;
  Orientation orientation;
  std::unique_ptr<HoldMethod> method;  ///< made when it is needed first
  Points x, first;                     ///< in the unit, as `targets` are
  Handles pins;
  std::vector<HoldMethod::LineSpring> lines;
  Points targets;
  Points positions;
  Report report;
  std::vector<double> areas;
};

Flattener::State::State(const SpacePoints& vertices, const Triangles& triangles,
                        const FlattenOptions& options)
    : unit(vertices),
      patch(unit.of(vertices), triangles),
      pin_weight(options.pin_weight),
      orientation(patch.mesh.triangles, patch.flat),
      targets(0, 2) {
  const std::array<int, 2> edge = checked_edge(patch, options.fixed);
  tell(options, 0.0);
  std::optional<TwoSteps> steps;
  try {
    steps.emplace(patch, edge_weights(patch.mesh, patch.rest_of(), options.weights), edge);
    x = steps->adjusted(steps->similar());
  } catch (const SolveError&) {
    if (options.method == FlattenMethod::two_steps) throw;
  }
  if (options.method == FlattenMethod::two_steps) {
    for (int i = 0; i < options.iterations; ++i) {
      tell(options, static_cast<double>(i) / options.iterations);
      x = steps->adjusted(x);
    }
    report.iterations = report.substeps = options.iterations;
  } else {
    steps.reset();
    const bool unrolled = x.rows() != 0 && upright(x);
    if (!unrolled) x = tutte_map(patch);
    descend(options);
    if (unrolled && orientation.count_flipped(x) > 0) {
      x = tutte_map(patch);
      descend(options);
    }
    if (orientation.count_flipped(x) > 0) {
      throw SolveError(
          "no flat shape without flipped triangles was found: cut the surface, or dissolve slivers");
    }
  }
  x = options.fixed ? placed_by_edge(patch, x, edge) : placed_by_length(patch, x, edge);
  for (int v = 0; v < patch.mesh.n_vertices; ++v) {
    if (patch.mesh.part[at(v)] < 0) x.row(v).setZero();
  }
  if (method) method->reset();
  report.flipped = orientation.count_flipped(x);
  first = x;
  positions = unit.back(x);
  tell(options, 1.0);
}

/// All triangles that are judged lie counter-clockwise, as float32.
bool Flattener::State::upright(const Points& at_x) {
  if (!at_x.allFinite()) return false;
  orientation.measure(at_x, areas);
  return std::all_of(areas.begin(), areas.end(), [](double area) { return area > 0.0; });
}

HoldMethod& Flattener::State::hold() {
  if (!method) {
    const double size = 2.0 * std::sqrt(patch.area / std::numbers::pi);
    method = std::make_unique<HoldMethod>(patch.mesh, patch.rest_of(), orientation, size);
  }
  return *method;
}

/// Moves x to least distortion, without pins.
void Flattener::State::descend(const FlattenOptions& options) {
  const int budget = options.iterations > 0 ? options.iterations : most_steps;
  report = {};
  double left = 1.0;
  const auto before_step = [&] {
    tell(options, 1.0 - left);
    left *= still_to_do;
  };
  // Triangles that float32 did not tell at first may need another round.
  Report now;
  do {
    hold().settle_within(budget - report.iterations, before_step, targets, x, now);
    report.iterations += now.iterations;
    report.substeps += now.substeps;
  } while (!now.converged && now.substeps > 0 && report.iterations < budget);
  report.converged = now.converged;
}

/// The largest distance of a pin from its target, or of a vertex from its line.
double Flattener::State::furthest(const Points& at_x, const Points& towards) const {
  double result = 0.0;
  if (pins.size() > 0) result = (pins.positions(at_x) - towards).rowwise().norm().maxCoeff();
  for (const HoldMethod::LineSpring& line : lines) {
    result = std::max(result, std::abs(line.normal.dot(at_x.row(line.vertex)) - line.offset));
  }
  return result;
}

void Flattener::State::act(Action action, Points towards) {
  Report done;
  Points next = x;
  (hold().*action)(towards, next, done);
  done.furthest_handle = unit.back(Points::Constant(1, 2, furthest(next, towards)))(0, 0);
  done.flipped = orientation.count_flipped(next);
  std::swap(x, next);
  targets = std::move(towards);
  positions = unit.back(x);
  report = done;
}

Flattener::Flattener(const SpacePoints& vertices, const Triangles& triangles, const FlattenOptions& options) {
  require_options(options);
  state_ = std::make_unique<State>(vertices, triangles, options);
}

Flattener::Flattener(Flattener&&) noexcept = default;
Flattener& Flattener::operator=(Flattener&&) noexcept = default;
Flattener::~Flattener() = default;

void Flattener::set_pins(Handles pins, std::vector<HeldLine> lines, const Eigen::VectorXd& weights) {
  State& state = *state_;
  HandleSet set{std::move(pins), {}, {}, {}};
  set.strength.setConstant(set.handles.size(), state.pin_weight);
  if (weights.size() != 0) {
    require_rows("weights", weights.size(), set.handles.size(), "handle");
    require_positive("weights", weights);
    set.strength.array() *= weights.array();
  }
  std::vector<HoldMethod::LineSpring> springs;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const HeldLine& line = lines[i];
    const auto refuse = [i](const char* what) {
      throw std::invalid_argument("lines, row " + std::to_string(i) + ": " + what);
    };
    if (line.vertices.size() == 0) refuse("no vertices");
    if (!line.point.allFinite() || !line.direction.allFinite()) refuse("not a finite number");
    if (!(line.direction.stableNorm() > 0.0)) refuse("no direction");
    const Eigen::RowVector2d along = line.direction.stableNormalized(), normal(-along.y(), along.x());
    for (Eigen::Index row = 0; row < line.vertices.size(); ++row) {
      const int v = line.vertices[row];
      require_index("lines", static_cast<Eigen::Index>(i), "vertex", v, state.patch.mesh.n_vertices);
      if (state.patch.mesh.part[at(v)] < 0) continue;
      springs.push_back({v, normal, normal.dot(state.unit.of(Points(line.point)).row(0)), state.pin_weight});
    }
  }
  state.hold().set_handles(set);
  state.hold().set_lines(springs);
  state.lines = std::move(springs);
  state.pins = std::move(set.handles);
  state.targets = state.pins.positions(state.x);
}

HeldLine Flattener::fitted_line(const Eigen::VectorXi& vertices) const {
  const State& state = *state_;
  using Complex = std::complex<double>;
  Complex mean = 0.0, square = 0.0;
  for (Eigen::Index i = 0; i < vertices.size(); ++i) {
    require_index("vertices", i, "vertex", vertices[i], state.patch.mesh.n_vertices);
    mean += complex_row(state.x, vertices[i]) / static_cast<double>(vertices.size());
  }
  for (const int v : vertices) square += std::pow(complex_row(state.x, v) - mean, 2);
  if (!(std::abs(square) > 0.0)) throw std::invalid_argument("vertices: they do not tell a line");
  const Complex direction = std::polar(1.0, 0.5 * std::arg(square));
  Points point(1, 2);
  point << mean.real(), mean.imag();
  return {vertices, state.unit.back(point).row(0), {direction.real(), direction.imag()}};
}

const Points& Flattener::move(const Points& targets) {
  require_rows("targets", targets.rows(), state_->pins.size(), "pin");
  require_finite("targets", targets);
  state_->act(&PosingMethod::move, state_->unit.of(targets));
  return state_->positions;
}

const Points& Flattener::refine() {
  state_->act(&PosingMethod::refine, state_->targets);
  return state_->positions;
}

const Points& Flattener::settle() {
  state_->act(&PosingMethod::settle, state_->targets);
  return state_->positions;
}

void Flattener::reset() {
  State& state = *state_;
  state.x = state.first;
  state.positions = state.unit.back(state.x);
  state.targets = state.pins.positions(state.x);
  state.report = {};
  state.report.flipped = state.orientation.count_flipped(state.x);
  if (state.method) state.method->reset();
}

const Points& Flattener::positions() const { return state_->positions; }
const Report& Flattener::report() const { return state_->report; }

Points flatten(const SpacePoints& vertices, const Triangles& triangles, const FlattenOptions& options) {
  return Flattener(vertices, triangles, options).positions();
}

}  // namespace planar
