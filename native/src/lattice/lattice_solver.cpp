// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "base/index.h"
#include "lattice/hold_lattice.h"
#include "lattice/lattice_input.h"
#include "lattice/paper_lattice.h"
#include "mesh/orientation.h"
#include "mesh/triangle_shape.h"
#include "planar/lattice.h"

namespace planar {

namespace {

constexpr double unreached = 1e-3;  // of the diagonal

constexpr double hold_handle = 1e3, hold_smooth = 1e-3;
constexpr double paper_handle = 1e2, paper_rest = 1e-2;

}  // namespace

struct LatticeSolver::State {
  State() = default;
  virtual ~State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  virtual void set_handles(const LatticeHandles& handles) = 0;
  virtual void solve(const Coordinates& mesh_targets, const Coordinates& lattice_targets) = 0;
  virtual void refine() = 0;
  virtual void settle() = 0;
  virtual void reset(const Coordinates& points) = 0;

  Coordinates lattice_rest, points, positions;
  LatticeReport report;
};

template <int D>
struct LatticeSolver::StateIn : State {
  using Outcome = typename LatticeMethod<D>::Outcome;

  StateIn(const Coordinates& rest_, const Elements& elements, const LatticeWeights& weights_,
          const Coordinates& lattice_rest_, LatticeMethodKind kind, const LatticeOptions& options)
      : rest(rest_),
        weights(weights_),
        points_at_rest(lattice_rest_),
        size((rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm()),
        springs(points_at_rest.rows()),
        pose{Rows<D>::Zero(points_at_rest.rows(), D), Rows<D>::Zero(rest.rows(), D), 0} {
    const bool hold = kind == LatticeMethodKind::hold;
    mesh_weight = options.weight_mesh.value_or(hold ? hold_handle : paper_handle);
    lattice_weight = options.weight_lattice.value_or(hold ? hold_handle : paper_handle);
    const double weight_rest = options.weight_rest.value_or(hold ? hold_smooth : paper_rest);
    if constexpr (D == 2) {
      if (const auto* triangles = std::get_if<Triangles>(&elements)) {
        orientation.emplace(rest, *triangles, flat_triangles(rest, *triangles));
        if (hold) {
          method = std::make_unique<HoldLattice>(rest, *triangles, weights, points_at_rest, size,
                                                 options.weight_shape, weight_rest);
          keeps_upright = true;
        }
      }
    }
    if (!hold) {
      method = std::make_unique<PaperLattice<D>>(
          rest, elements, weights, points_at_rest, size,
          PaperWeights{options.weight_shape, weight_rest, options.rigid_following,
                       options.edge_weights == EdgeWeights::area});
    }
    method->compile(springs);
    lattice_rest = points = lattice_rest_;
    positions = rest_;
  }

  void set_handles(const LatticeHandles& handles) override;
  void solve(const Coordinates& mesh_targets, const Coordinates& lattice_targets) override;
  void refine() override { go_on(&LatticeMethod<D>::refine); }
  void settle() override { go_on(&LatticeMethod<D>::settle); }
  void reset(const Coordinates& to) override;

  void go_on(Outcome (LatticeMethod<D>::*work)(const LatticeSprings<D>&, LatticePose<D>&));
  /// Takes what is ahead as the pose.
  void show(const LatticeSprings<D>& towards, const Outcome& outcome);
  /// Triangles that lie the other way round, and those that are wrong in a LatticePose, at x.
  std::pair<int, int> count_wrong(const Rows<D>& x) const;
  /// Compiled with these handles, or else with those before, if that works again.
  void compile(const LatticeSprings<D>& next);

  Rows<D> rest;
  LatticeWeights weights;
  Rows<D> points_at_rest;
  double size, mesh_weight = 0.0, lattice_weight = 0.0;
  std::unique_ptr<LatticeMethod<D>> method;
  std::optional<Orientation> orientation;
  LatticeSprings<D> springs;
  bool keeps_upright = false;  ///< the method knows of triangles that lie wrong
  bool compiled = true, has_targets = false;
  LatticePose<D> pose;
  LatticePose<D> ahead;  ///< of a call under way
};

template <int D>
std::pair<int, int> LatticeSolver::StateIn<D>::count_wrong(const Rows<D>& x) const {
  std::pair<int, int> result{0, 0};
  if constexpr (D == 2) {
    if (!orientation) return result;
    std::vector<double> areas;
    orientation->measure(x, areas);
    for (const double area : areas) {
      result.first += area < 0.0;
      result.second += !(area > 0.0);
    }
  }
  return result;
}

template <int D>
void LatticeSolver::StateIn<D>::compile(const LatticeSprings<D>& next) {
  compiled = false;
  method->compile(next);
  compiled = true;
}

template <int D>
void LatticeSolver::StateIn<D>::set_handles(const LatticeHandles& handles) {
  require_handles(handles, rest.rows(), points_at_rest.rows());
  LatticeSprings<D> next(points_at_rest.rows());
  const Eigen::Index k = handles.mesh.size();
  RowSum sum(weights);
  std::vector<Eigen::Triplet<double>> entries;
  next.rest.setZero(k, D);
  for (Eigen::Index h = 0; h < k; ++h) {
    sum.clear(1);
    for (int c = 0; c < 3; ++c) {
      const double share = handles.mesh.weights(h, c);
      if (share == 0.0) continue;
      const int vertex = handles.mesh.vertices(h, c);
      sum.add(vertex, std::array{share});
      next.rest.row(h) += share * rest.row(vertex);
    }
    for (int i = 0; i < sum.size(); ++i) {
      entries.emplace_back(static_cast<int>(h), sum.points()[at(i)], sum.value(i, 0));
    }
  }
  next.rows.resize(k, points_at_rest.rows());
  next.rows.setFromTriplets(entries.begin(), entries.end());
  next.weight.setConstant(k, mesh_weight);
  if (handles.weights.size() != 0) next.weight.array() *= handles.weights.array();
  next.targets = next.rest;
  next.point_weight = lattice_weight;
  next.points.assign(handles.lattice_points.begin(), handles.lattice_points.end());
  next.point_rest = points_at_rest(next.points, Eigen::all);
  next.point_targets = next.point_rest;
  for (const int point : handles.lattice_points) next.is_point[at(point)] = 1;
  for (const int point : handles.locked) next.locked[at(point)] = 1;
  try {
    compile(next);
  } catch (...) {
    method->compile(springs);
    compiled = true;
    throw;
  }
  springs = std::move(next);
  has_targets = false;
}

template <int D>
void LatticeSolver::StateIn<D>::solve(const Coordinates& mesh_targets, const Coordinates& lattice_targets) {
  const auto n_points = static_cast<Eigen::Index>(springs.points.size());
  require_targets("vertex_targets", mesh_targets, springs.rows.rows(), D);
  require_targets("lattice_targets", lattice_targets, n_points, D);
  if (springs.empty()) return;
  LatticeSprings<D> towards = springs;
  if (mesh_targets.rows() > 0) towards.targets = mesh_targets;
  if (n_points > 0) towards.point_targets = lattice_targets;
  if (!compiled) compile(springs);
  ahead = pose;
  const Outcome outcome = method->move(towards, ahead);
  show(towards, outcome);
  springs = std::move(towards);
  has_targets = true;
}

template <int D>
void LatticeSolver::StateIn<D>::go_on(Outcome (LatticeMethod<D>::*work)(const LatticeSprings<D>&,
                                                                        LatticePose<D>&)) {
  if (!has_targets) return;
  if (!compiled) compile(springs);
  ahead = pose;
  const Outcome outcome = (method.get()->*work)(springs, ahead);
  show(springs, outcome);
}

template <int D>
void LatticeSolver::StateIn<D>::show(const LatticeSprings<D>& towards, const Outcome& outcome) {
  LatticeReport done;
  done.iterations = outcome.iterations;
  done.converged = outcome.converged;
  done.handle_distance = (towards.places(ahead.d) - towards.targets).rowwise().norm();
  for (Eigen::Index h = 0; h < done.handle_distance.size(); ++h) {
    done.furthest_handle = std::max(done.furthest_handle, done.handle_distance[h]);
    if (done.handle_distance[h] > unreached * size) done.unreached.push_back(static_cast<int>(h));
  }
  for (std::size_t i = 0; i < towards.points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double off =
        (towards.point_rest.row(row) + ahead.d.row(towards.points[i]) - towards.point_targets.row(row))
            .norm();
    done.furthest_handle = std::max(done.furthest_handle, off);
  }
  if (!keeps_upright || ahead.wrong > 0) std::tie(done.flipped, ahead.wrong) = count_wrong(rest + ahead.u);
  positions = rest + ahead.u;
  points = points_at_rest + ahead.d;
  std::swap(pose, ahead);
  report = std::move(done);
}

template <int D>
void LatticeSolver::StateIn<D>::reset(const Coordinates& to) {
  require_rows("points", to.rows(), points_at_rest.rows(), "point of the lattice");
  if (to.cols() != D) {
    throw std::invalid_argument("points has " + std::to_string(to.cols()) + " columns, expected " +
                                std::to_string(D));
  }
  require_finite_rows("points", to);
  ahead.d = Rows<D>(to) - points_at_rest;
  product<D>(weights, ahead.d, ahead.u);
  LatticeReport done;
  std::tie(done.flipped, ahead.wrong) = count_wrong(rest + ahead.u);
  positions = rest + ahead.u;
  points = to;
  std::swap(pose, ahead);
  report = std::move(done);
  has_targets = false;
}

LatticeSolver::LatticeSolver(const Coordinates& rest, const Elements& elements, const LatticeWeights& weights,
                             const Coordinates& lattice_rest, const LatticeOptions& options) {
  require_model(rest, elements, weights, lattice_rest);
  const bool triangles_in_2d = rest.cols() == 2 && std::holds_alternative<Triangles>(elements);
  const LatticeMethodKind kind =
      options.method.value_or(triangles_in_2d ? LatticeMethodKind::hold : LatticeMethodKind::paper);
  require_options(options, kind, triangles_in_2d);
  if (rest.cols() == 2) {
    state_ = std::make_unique<StateIn<2>>(rest, elements, in_order(weights), lattice_rest, kind, options);
  } else {
    state_ = std::make_unique<StateIn<3>>(rest, elements, in_order(weights), lattice_rest, kind, options);
  }
}

LatticeSolver::LatticeSolver(LatticeSolver&&) noexcept = default;
LatticeSolver& LatticeSolver::operator=(LatticeSolver&&) noexcept = default;
LatticeSolver::~LatticeSolver() = default;

void LatticeSolver::set_handles(const LatticeHandles& handles) { state_->set_handles(handles); }

const Coordinates& LatticeSolver::solve(const Coordinates& mesh_targets, const Coordinates& lattice_targets) {
  state_->solve(mesh_targets, lattice_targets);
  return state_->points;
}

const Coordinates& LatticeSolver::refine() {
  state_->refine();
  return state_->points;
}

const Coordinates& LatticeSolver::settle() {
  state_->settle();
  return state_->points;
}

void LatticeSolver::reset() { state_->reset(state_->lattice_rest); }
void LatticeSolver::reset(const Coordinates& points) { state_->reset(points); }
const Coordinates& LatticeSolver::points() const { return state_->points; }
const Coordinates& LatticeSolver::positions() const { return state_->positions; }
const LatticeReport& LatticeSolver::report() const { return state_->report; }

}  // namespace planar
