// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/cage_method.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/checks.h"
#include "base/diameter.h"
#include "base/disjoint_sets.h"
#include "base/index.h"
#include "cage/refinement.h"
#include "mesh/triangle_shape.h"
#include "posing/upright_patches.h"

namespace planar {

namespace {

constexpr double negligible = 1e-6;  // of the size: what the fit leaves of float32
constexpr double released = 1e-5;    // of the size: what is left then is dropped
constexpr double unmoved = 1e-5;     // of the size: a further settle() is not worth it
constexpr double nearby = 0.1;       // of the size: what the mesh may have beside a minimum of the cage
constexpr double reach = 0.2;        // of the size: the way on which that is let go of
constexpr int settle_rounds = 12;

/// Each triangle of the cage is as stiff as the dense ones in it: their harmonic mean by area. Where a stiff
/// region ends inside of a triangle the arithmetic mean would widen it: with half of a square 30 times as
/// stiff, the pose is off by 0.008 of the side in the mean, and by 0.001 with this one.
Eigen::VectorXd carried_stiffness(const Cage& cage, const Points& rest, const Triangles& triangles,
                                  const Eigen::VectorXd& stiffness) {
  if (stiffness.size() == 0) return {};
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(cage.triangles.rows()), area = sum;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double share = std::abs(doubled_area(rest, triangles.data() + 3 * t));
    for (int c = 0; c < 3; ++c) {
      const int owner = cage.places[at(triangles(t, c))].triangle;
      sum[owner] += share / stiffness[t];
      area[owner] += share;
    }
  }
  // Every triangle of the cage has a corner that is a dense vertex, but that need not lie in it.
  const double mean = area.sum() / sum.sum();
  for (Eigen::Index t = 0; t < sum.size(); ++t) sum[t] = area[t] > 0.0 ? area[t] / sum[t] : mean;
  return sum;
}

/// Dense vertices at points that pull by themselves, ascending.
std::vector<int> pulled_at(const HandleSet& set, const JointSet& joints) {
  std::vector<int> result;
  const auto add = [&result](const Handles& handles, Eigen::Index row) {
    Eigen::Index corner = 0;
    handles.weights.row(row).maxCoeff(&corner);
    result.push_back(handles.vertices(row, corner));
  };
  for (Eigen::Index row = 0; row < set.handles.size(); ++row) {
    if (!set.patch[at(row)]) add(set.handles, row);
  }
  for (Eigen::Index row = 0; row < joints.first.size(); ++row) {
    add(joints.first, row);
    add(joints.second, row);
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

/// Flags of the cage's parts that have handles, or hang together with one that has. All handles are the
/// cage's.
std::vector<char> held_by(const Handles& handles, const JointSet& joints, const Mesh& mesh) {
  const auto part_of = [&](const Handles& of, Eigen::Index row) {
    return mesh.part[at(of.vertices(row, 0))];
  };
  DisjointSets together(at(mesh.n_parts));
  for (Eigen::Index row = 0; row < joints.first.size(); ++row)
    together.join(part_of(joints.first, row), part_of(joints.second, row));
  std::vector<char> group(at(mesh.n_parts)), result(group.size());
  for (Eigen::Index row = 0; row < handles.size(); ++row) {
    const int part = part_of(handles, row);
    if (part >= 0) group[at(together.find(part))] = 1;
  }
  for (int part = 0; part < mesh.n_parts; ++part) result[at(part)] = group[at(together.find(part))];
  return result;
}

Orientation orientation_of(const Cage& cage, const Eigen::RowVector2d& centre) {
  const Points rest = cage.rest.rowwise() + centre;
  return {rest, cage.triangles, flat_triangles(rest, cage.triangles), centre};
}

}  // namespace

CageMethod::Solved::Solved(Cage made, const CageMethod& owner, std::vector<int> refined_near)
    : cage(std::move(made)),
      mesh(cage.rest.rows(), cage.triangles),
      orientation(orientation_of(cage, owner.centre_)),
      suspects(cage, owner.rest_.rowwise() + owner.centre_, owner.orientation_.triangles()),
      fit(cage, mesh),
      stiffness(carried_stiffness(cage, owner.rest_, owner.orientation_.triangles(), owner.stiffness_)),
      method(owner.make_(cage.rest, cage.triangles, orientation, stiffness)),
      hold(owner.rest_.rows() <= most_polished ? dynamic_cast<HoldMethod*>(method.get()) : nullptr),
      near(std::move(refined_near)) {
  if (hold != nullptr) sample.emplace(cage, owner.rest_, owner.orientation_.triangles());
}

CageMethod::CageMethod(Coarse coarse, const Points& rest, const Eigen::RowVector2d& centre,
                       const Orientation& orientation, const Eigen::VectorXd& stiffness, double kept,
                       Make make)
    : coarse_(std::move(coarse)),
      rest_(rest),
      centre_(centre),
      orientation_(orientation),
      stiffness_(stiffness),
      size_(diameter(coarse_.points)),
      kept_(kept),
      make_(std::move(make)) {}

/// Checks handles of the mesh.
void CageMethod::require_points(const Handles& handles, const char* name) const {
  const Triangles& triangles = orientation_.triangles();
  std::map<std::pair<int, int>, int> sides;  // that must be there, and the row of a handle that says so
  std::vector<char> of_side(at(rest_.rows()));
  for (int row = 0; row < static_cast<int>(handles.size()); ++row) {
    const auto needed = [&](int a, int b) {
      sides.emplace(std::minmax(a, b), row);
      of_side[at(a)] = of_side[at(b)] = 1;
      return true;
    };
    point_of(handles, row, static_cast<int>(rest_.rows()), needed, name);
  }
  for (Eigen::Index t = 0; t < triangles.rows() && !sides.empty(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int a = triangles(t, c), b = triangles(t, (c + 1) % 3);
      if (of_side[at(a)] && of_side[at(b)]) sides.erase(std::minmax(a, b));
    }
  }
  if (!sides.empty()) {
    throw std::invalid_argument(row_of(name, sides.begin()->second) +
                                "its vertices are not those of one triangle");
  }
}

/// Replaces handles and joints, or throws and keeps those of before.
void CageMethod::set(const HandleSet& set, const JointSet& joints, bool new_joints) {
  require_rows("handles.weights", set.handles.weights.rows(), set.handles.size(), "handle");
  require_rows("first.weights", joints.first.weights.rows(), joints.first.size(), "handle");
  require_rows("second.weights", joints.second.weights.rows(), joints.second.size(), "handle");
  require_points(set.handles, "handles");
  require_points(joints.first, "first");
  require_points(joints.second, "second");
  std::vector<int> points = pulled_at(set, joints);
  std::unique_ptr<Solved> made;
  if (!on_ || !std::includes(on_->near.begin(), on_->near.end(), points.begin(), points.end())) {
    made = std::make_unique<Solved>(make_cage(rest_, refined_near(rest_, coarse_, points)), *this, points);
  }
  const Solved& on = made ? *made : *on_;
  HandleSet on_cage = set;
  on_cage.handles = caged(set.handles, on.cage, rest_);
  const JointSet joints_on_cage{caged(joints.first, on.cage, rest_), caged(joints.second, on.cage, rest_),
                                joints.strength};
  if (new_joints || (made && joints.first.size() != 0)) on.method->set_joints(joints_on_cage);
  std::vector<char> held = held_by(on_cage.handles, joints_on_cage, on.mesh);
  std::vector<char> stays(at(rest_.rows()));  // what has no handles
  for (std::size_t v = 0; v < stays.size(); ++v) {
    const int triangle = on.cage.places[v].triangle;
    stays[v] = triangle < 0 || !held[at(on.mesh.part[at(on.cage.triangles(triangle, 0))])];
  }
  std::vector<char> pinned = stays;
  for (const Handles* handles : {&set.handles, &joints.first, &joints.second}) {
    for (const int v : handles->vertices.reshaped()) pinned[at(v)] = 1;
  }
  on.method->set_handles(on_cage);
  if (made) {
    on_ = std::move(made);
    x_.resize(0, 2);
    unseen_ = true;
  }
  handles_ = set;
  joints_ = joints;
  if (new_joints) polish_.reset();
  if (polish_) polish_->set_handles(handles_);
  coarse_settled_ = false;
  stays_ = std::move(stays);
  pinned_ = std::move(pinned);
  cage_handles_ = std::move(on_cage.handles);
  held_ = std::move(held);
}

/// Whether x is what the last call made, but for rounding.
bool CageMethod::is_as_left(const Points& x) const {
  if (x_.rows() == 0) return false;
  const Remainder::Turns turns = turns_at(x_, left_);
  std::size_t next = 0;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Place& place = on_->cage.places[at(v)];
    Eigen::RowVector2d expected = x.row(v);
    if (next < repaired_.size() && repaired_[next] == v) {
      expected = repaired_places_.row(static_cast<Eigen::Index>(next++));
    } else if (place.triangle >= 0) {
      expected = carried(place, on_->cage.triangles, x_);
      if (!turns.empty()) expected += beside_.of(on_->cage, v, turns);
    }
    if (!((x.row(v) - expected).squaredNorm() <= negligible * negligible * size_ * size_)) return false;
  }
  return true;
}

void CageMethod::reset() noexcept {
  unseen_ = true;
  coarse_settled_ = false;
}

/// The mesh's positions are x.
void CageMethod::take(const Points& x) {
  unseen_ = false;
  // Where the cage begins depends on x alone, whatever led there.
  if (on_->hold == nullptr && is_as_left(x)) return;
  balanced_.resize(0, 2);
  if (on_->hold != nullptr && orientation_.count_flipped(x) == 0 && balance(x)) return;
  x_ = on_->fit.fit(x);
  take_beside(Remainder(on_->cage, x_, x, negligible * size_));
  on_->method->reset();
}

void CageMethod::take_beside(Remainder beside) {
  beside_ = std::move(beside);
  left_.assign(at(on_->mesh.n_parts), beside_.is_empty() ? 0.0 : 1.0);
}

/// Puts the cage to its own minimum, for handles that pull at it as they do at the mesh, if that is near.
bool CageMethod::balance(const Points& x) {
  Points settled = on_->sample->at(on_->cage, x);
  std::vector<int> all(at(on_->cage.triangles.rows()));
  std::iota(all.begin(), all.end(), 0);
  turn_upright(on_->cage.rest, on_->orientation, centre_, on_->stiffness,
               std::vector<char>(at(settled.rows())), all, settled);
  if (on_->orientation.count_flipped(settled) != 0 || on_->hold->is_knotted(settled)) return false;
  const Points places = handles_.handles.positions(x);
  Points targets = places;
  on_->hold->go_on();
  try {
    for (int round = 0; round < 2; ++round) {
      Report report;
      on_->hold->settle(targets, settled, report);
      if (!report.converged) return false;
      // As far behind their targets as the springs are drawn out at these places.
      targets = 2.0 * places - cage_handles_.positions(settled);
    }
  } catch (const SolveError&) {
    return false;
  }
  Remainder beside(on_->cage, settled, x, negligible * size_);
  if (!(beside.largest() <= nearby * size_)) return false;
  x_ = balanced_ = std::move(settled);
  take_beside(std::move(beside));
  return true;
}

/// How far each part of the cage is from its minimum beside the mesh: 1 there, 0 out of reach.
std::vector<double> CageMethod::nearness() const {
  std::vector<double> furthest(at(on_->mesh.n_parts));
  for (int c = 0; c < on_->mesh.n_vertices; ++c) {
    const int part = on_->mesh.part[at(c)];
    if (part >= 0) furthest[at(part)] = std::max(furthest[at(part)], (x_.row(c) - balanced_.row(c)).norm());
  }
  for (double& way : furthest) way = std::max(0.0, 1.0 - way / (reach * size_));
  return furthest;
}

/// How much of what the fit left each part keeps.
std::vector<double> CageMethod::left_after(double kept) const {
  std::vector<double> result = left_;
  if (balanced_.rows() != 0) {
    const std::vector<double> near = nearness();
    for (std::size_t part = 0; part < result.size(); ++part) {
      if (held_[part] && !beside_.is_empty()) result[part] = near[part];
    }
    return result;
  }
  for (std::size_t part = 0; part < result.size(); ++part) {
    if (!held_[part]) continue;
    result[part] *= kept;
    if (kept < 1.0 && result[part] * beside_.largest() <= released * size_) result[part] = 0.0;
  }
  return result;
}

/// By triangle of the cage: how what is beside it is turned and shortened. Empty if there is nothing.
Remainder::Turns CageMethod::turns_at(const Points& x, const std::vector<double>& left) const {
  Remainder::Turns result = beside_.turns_to(on_->cage, x);
  for (std::size_t t = 0; t < result.size(); ++t)
    result[t] *= left[at(on_->mesh.part[at(on_->cage.triangles(static_cast<Eigen::Index>(t), 0))])];
  return result;
}

/// From the points of the cage that the handles are for to where the mesh has them.
Points CageMethod::offsets(const std::vector<double>& left) const {
  const Remainder::Turns turns = turns_at(x_, left);
  Points result = -cage_handles_.positions(x_);
  for (Eigen::Index row = 0; row < result.rows(); ++row) {
    for (int c = 0; c < 3; ++c) {
      const int v = handles_.handles.vertices(row, c);
      const Place& place = on_->cage.places[at(v)];
      if (place.triangle < 0) continue;
      Eigen::RowVector2d p = carried(place, on_->cage.triangles, x_);
      if (!turns.empty()) p += beside_.of(on_->cage, v, turns);
      result.row(row) += handles_.handles.weights(row, c) * p;
    }
  }
  return result;
}

void CageMethod::move(const Points& targets, Points& x, Report& report) {
  act(&PosingMethod::move, 1, kept_, targets, x, report);
}

void CageMethod::refine(const Points& targets, Points& x, Report& report) {
  if (coarse_settled_) {
    polish(&DensePolish::refine, targets, x, report);
  } else {
    act(&PosingMethod::refine, 1, kept_, targets, x, report);
  }
}

void CageMethod::settle(const Points& targets, Points& x, Report& report) {
  if (!coarse_settled_)
    act(&PosingMethod::settle, settle_rounds, kept_ < 1.0 ? 0.0 : 1.0, targets, x, report);
  if (!on_ || on_->hold == nullptr || targets.rows() == 0) return;
  coarse_settled_ = true;
  try {
    polish(&DensePolish::settle, targets, x, report);
  } catch (...) {
    reset();  // the cage is no longer where the mesh stays
    throw;
  }
}

/// Takes the mesh itself to its minimum, or nearer to it.
void CageMethod::polish(Polish action, const Points& targets, Points& x, Report& report) {
  if (!polish_) {
    polish_ = std::make_unique<DensePolish>(rest_, orientation_, stiffness_, joints_);
    polish_->set_handles(handles_);
  }
  if (orientation_.count_flipped(x) > 0) {
    // Descents turn nothing over, so they may never turn it back. Pins, where it mostly is, make way: a
    // descent brings them back.
    std::vector<int> all(at(orientation_.triangles().rows()));
    std::iota(all.begin(), all.end(), 0);
    turn_upright(rest_, orientation_, centre_, stiffness_, stays_, all, x);
  }
  Report done;
  (polish_.get()->*action)(targets, progress(), x, done);
  unseen_ = true;
  report.iterations += done.iterations;
  report.substeps += done.substeps;
  report.converged = done.converged;
  report.coarse_settled = true;
  report.flipped = orientation_.count_flipped(x);
  if (done.converged) polish_.reset();  // drawings that rest keep no factor of their own
}

void CageMethod::act(Action action, int rounds, double kept, const Points& targets, Points& x,
                     Report& report) {
  if (!on_) {
    report.flipped = orientation_.count_flipped(x);
    return;
  }
  if (unseen_) take(x);
  const std::vector<double> left = left_after(kept);
  const Points before = x_;
  Points now = x_;
  try {
    Points beyond = offsets(left);
    for (int round = 0; round < rounds; ++round) {
      Report done;
      (on_->method.get()->*action)(targets - beyond, now, done);
      report.iterations += done.iterations;
      report.substeps += done.substeps;
      report.converged = done.converged;
      x_ = now;
      const Points after = offsets(left);
      const double change = after.rows() == 0 ? 0.0 : (after - beyond).rowwise().norm().maxCoeff();
      if (change <= unmoved * size_) break;
      beyond = after;
    }
  } catch (...) {
    x_ = before;
    throw;
  }
  std::vector<char> moves(left.size());
  for (std::size_t part = 0; part < left.size(); ++part) {
    moves[part] = left[part] != left_[part];
    if (left[part] > 0.0 && kept < 1.0 && held_[part] && balanced_.rows() == 0) report.converged = false;
  }
  for (int c = 0; c < on_->mesh.n_vertices; ++c) {
    if (on_->mesh.part[at(c)] >= 0 && x_.row(c) != before.row(c)) moves[at(on_->mesh.part[at(c)])] = 1;
  }
  left_ = left;
  carry(moves, x);
  const std::vector<int> suspects = on_->suspects.at(on_->cage, x_, !beside_.is_empty());
  repaired_ = turn_upright(rest_, orientation_, centre_, stiffness_, pinned_, suspects, x);
  repaired_places_ = x(repaired_, Eigen::all);
  report.flipped = repaired_.empty() ? static_cast<int>(orientation_.flipped_of(suspects, x).size())
                                     : orientation_.count_flipped(x);
  coarse_settled_ = report.coarse_settled = on_->hold != nullptr && targets.rows() != 0 && report.converged;
  if (coarse_settled_) report.converged = false;
}

/// Takes the vertices of these parts of the mesh to where the cage has them.
void CageMethod::carry(const std::vector<char>& parts, Points& x) const {
  std::vector<char> moves(at(on_->cage.triangles.rows()));
  for (std::size_t t = 0; t < moves.size(); ++t)
    moves[t] = parts[at(on_->mesh.part[at(on_->cage.triangles(static_cast<Eigen::Index>(t), 0))])];
  const Remainder::Turns turns = turns_at(x_, left_);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Place& place = on_->cage.places[at(v)];
    if (place.triangle < 0 || !moves[at(place.triangle)]) continue;
    x.row(v) = carried(place, on_->cage.triangles, x_);
    if (!turns.empty()) x.row(v) += beside_.of(on_->cage, v, turns);
  }
}

}  // namespace planar
