// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/cage_method.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <utility>

#include "base/checks.h"
#include "base/complex_rows.h"
#include "base/diameter.h"
#include "base/index.h"
#include "cage/refinement.h"
#include "mesh/triangle_shape.h"

namespace planar {

namespace {

constexpr double negligible = 1e-6;  // of the size: what the fit leaves of float32
constexpr double released = 1e-5;    // of the size: what is left then is dropped
constexpr double unmoved = 1e-6;     // of the size: a further settle() is not worth it
constexpr int settle_rounds = 4;

/// Each triangle of the cage is as stiff as the dense ones in it, in the mean by area.
Eigen::VectorXd carried_stiffness(const Cage& cage, const Points& rest, const Triangles& triangles,
                                  const Eigen::VectorXd& stiffness) {
  if (stiffness.size() == 0) return {};
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(cage.triangles.rows()), area = sum;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double share = std::abs(doubled_area(rest, triangles.data() + 3 * t));
    for (int c = 0; c < 3; ++c) {
      const int owner = cage.places[at(triangles(t, c))].triangle;
      sum[owner] += share * stiffness[t];
      area[owner] += share;
    }
  }
  // Every triangle of the cage has a corner that is a dense vertex, but that need not lie in it.
  const double mean = sum.sum() / area.sum();
  for (Eigen::Index t = 0; t < sum.size(); ++t) sum[t] = area[t] > 0.0 ? sum[t] / area[t] : mean;
  return sum;
}

Orientation orientation_of(const Cage& cage, const Eigen::RowVector2d& centre) {
  const Points rest = cage.rest.rowwise() + centre;
  return {rest, cage.triangles, flat_triangles(rest, cage.triangles), centre};
}

/// The rotation of a triangle from one shape of the cage to another, 1 where there is none.
std::complex<double> turn_of(const int* corner, const Points& from, const Points& to) {
  const auto side = [corner](const Points& x, int c) {
    return complex_row(x, corner[c]) - complex_row(x, corner[0]);
  };
  const std::complex<double> area =
      side(from, 1) * std::conj(side(from, 2)) - side(from, 2) * std::conj(side(from, 1));
  const std::complex<double> a =
      (side(to, 1) * std::conj(side(from, 2)) - side(to, 2) * std::conj(side(from, 1))) / area;
  const double length = std::abs(a);
  return length > 0.0 && std::isfinite(length) ? a / length : 1.0;
}

}  // namespace

CageMethod::Solved::Solved(Cage made, const CageMethod& owner, std::vector<int> refined_near)
    : cage(std::move(made)),
      mesh(cage.rest.rows(), cage.triangles),
      orientation(orientation_of(cage, owner.centre_)),
      fit(cage, mesh),
      method(owner.make_(
          cage.rest, cage.triangles, orientation,
          carried_stiffness(cage, owner.rest_, owner.orientation_.triangles(), owner.stiffness_))),
      near(std::move(refined_near)) {}

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
      make_(std::move(make)),
      beside_(0, 2) {}

/// Checks handles of the mesh, and gives each the place of the cage that its point is at rest.
Handles CageMethod::caged(const Handles& handles, const Solved& on) const {
  require_rows("handles.weights", handles.weights.rows(), handles.size(), "handle");
  const Triangles& triangles = orientation_.triangles();
  std::map<std::pair<int, int>, int> sides;  // that must be there, and the row of a handle that says so
  std::vector<char> of_side(at(rest_.rows()));
  Handles result;
  result.vertices.resize(handles.size(), 3);
  result.weights.resize(handles.size(), 3);
  for (int row = 0; row < static_cast<int>(handles.size()); ++row) {
    const Pin point = point_of(handles, row, static_cast<int>(rest_.rows()), [&](int a, int b) {
      sides.emplace(std::minmax(a, b), row);
      of_side[at(a)] = of_side[at(b)] = 1;
      return true;
    });
    const Place place = place_of(point, on.cage);
    if (place.triangle < 0) {
      result.vertices.row(row).setConstant(static_cast<int>(on.cage.rest.rows()) - 1);
      result.weights.row(row) << 1.0, 0.0, 0.0;
      continue;
    }
    result.vertices.row(row) = on.cage.triangles.row(place.triangle);
    result.weights.row(row) << 1.0 - place.first - place.second, place.first, place.second;
  }
  for (Eigen::Index t = 0; t < triangles.rows() && !sides.empty(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int a = triangles(t, c), b = triangles(t, (c + 1) % 3);
      if (of_side[at(a)] && of_side[at(b)]) sides.erase(std::minmax(a, b));
    }
  }
  if (!sides.empty()) {
    throw std::invalid_argument(row_of("handles", sides.begin()->second) +
                                "its vertices are not those of one triangle");
  }
  return result;
}

/// Of its corners' triangles the one that holds the point best.
Place CageMethod::place_of(const Pin& point, const Cage& cage) const {
  Place best = cage.places[at(point.vertex[0])];
  if (point.n_corners == 1) return best;
  const Eigen::RowVector2d p = pinned_point(point, rest_);
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < point.n_corners; ++c) {
    const int triangle = cage.places[at(point.vertex[c])].triangle;
    if (triangle < 0) continue;
    const Place place = place_in(cage.rest, cage.triangles, triangle, p);
    const double least = std::min({place.first, place.second, 1.0 - place.first - place.second});
    if (least > most) {
      most = least;
      best = place;
    }
  }
  return best;
}

void CageMethod::set_handles(const HandleSet& set) {
  require_rows("handles.weights", set.handles.weights.rows(), set.handles.size(), "handle");
  std::vector<int> points;  // that pull by themselves
  for (Eigen::Index row = 0; row < set.handles.size(); ++row) {
    if (set.patch[at(row)]) continue;
    Eigen::Index corner = 0;
    set.handles.weights.row(row).maxCoeff(&corner);
    const int v = set.handles.vertices(row, corner);
    require_index("handles", row, "vertex", v, rest_.rows());
    points.push_back(v);
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::unique_ptr<Solved> made;
  if (!on_ || !std::includes(on_->near.begin(), on_->near.end(), points.begin(), points.end())) {
    made = std::make_unique<Solved>(make_cage(rest_, refined_near(rest_, coarse_, points)), *this, points);
  }
  const Solved& on = made ? *made : *on_;
  HandleSet on_cage = set;
  on_cage.handles = caged(set.handles, on);
  std::vector<char> held(at(on.mesh.n_parts));
  for (Eigen::Index row = 0; row < on_cage.handles.size(); ++row) {
    const int part = on.mesh.part[at(on_cage.handles.vertices(row, 0))];
    if (part >= 0) held[at(part)] = 1;
  }
  on.method->set_handles(on_cage);
  if (made) {
    on_ = std::move(made);
    unseen_ = true;
  }
  handles_ = set.handles;
  cage_handles_ = std::move(on_cage.handles);
  held_ = std::move(held);
}

/// The mesh's positions are x.
void CageMethod::take(const Points& x) {
  Points fitted = on_->fit.fit(x);
  Points left = x;
  double most = 0.0;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Place& place = on_->cage.places[at(v)];
    if (place.triangle < 0) continue;
    left.row(v) -= carried(place, on_->cage.triangles, fitted);
    most = std::max(most, left.row(v).squaredNorm());
  }
  const bool worth_keeping = std::sqrt(most) > negligible * size_;
  if (!worth_keeping) left.resize(0, 2);
  left_.assign(at(on_->mesh.n_parts), worth_keeping ? 1.0 : 0.0);
  largest_left_ = std::sqrt(most);
  beside_ = std::move(left);
  fitted_ = fitted;
  x_ = std::move(fitted);
  on_->method->reset();
  unseen_ = false;
}

/// How much of what the fit left each part keeps.
std::vector<double> CageMethod::left_after(double kept) const {
  std::vector<double> result = left_;
  for (std::size_t part = 0; part < result.size(); ++part) {
    if (held_[part]) result[part] *= kept;
    if (held_[part] && result[part] * largest_left_ <= released * size_ && kept < 1.0) result[part] = 0.0;
  }
  return result;
}

/// What is beside the carried place of a dense vertex when the cage is at x.
Eigen::RowVector2d CageMethod::beside(Eigen::Index v, const std::vector<std::complex<double>>& turns) const {
  const std::complex<double> p = turns[at(on_->cage.places[at(v)].triangle)] * complex_row(beside_, v);
  return {p.real(), p.imag()};
}

/// By triangle of the cage: how what is beside it is turned and shortened. Empty if there is nothing.
std::vector<std::complex<double>> CageMethod::turns_at(const Points& x,
                                                       const std::vector<double>& left) const {
  std::vector<std::complex<double>> result;
  if (beside_.rows() == 0) return result;
  for (Eigen::Index t = 0; t < on_->cage.triangles.rows(); ++t) {
    const int* corner = on_->cage.triangles.data() + 3 * t;
    result.push_back(left[at(on_->mesh.part[at(corner[0])])] * turn_of(corner, fitted_, x));
  }
  return result;
}

/// From the points of the cage that the handles are for to where the mesh has them.
Points CageMethod::offsets(const std::vector<double>& left) const {
  const std::vector<std::complex<double>> turns = turns_at(x_, left);
  Points result = -cage_handles_.positions(x_);
  for (Eigen::Index row = 0; row < result.rows(); ++row) {
    for (int c = 0; c < 3; ++c) {
      const int v = handles_.vertices(row, c);
      const Place& place = on_->cage.places[at(v)];
      if (place.triangle < 0) continue;
      Eigen::RowVector2d p = carried(place, on_->cage.triangles, x_);
      if (!turns.empty()) p += beside(v, turns);
      result.row(row) += handles_.weights(row, c) * p;
    }
  }
  return result;
}

void CageMethod::move(const Points& targets, Points& x, Report& report) {
  act(&PosingMethod::move, 1, kept_, targets, x, report);
}

void CageMethod::refine(const Points& targets, Points& x, Report& report) {
  act(&PosingMethod::refine, 1, kept_, targets, x, report);
}

void CageMethod::settle(const Points& targets, Points& x, Report& report) {
  act(&PosingMethod::settle, settle_rounds, kept_ < 1.0 ? 0.0 : 1.0, targets, x, report);
}

void CageMethod::act(Action action, int rounds, double kept, const Points& targets, Points& x,
                     Report& report) {
  if (!on_) return;
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
    if (left[part] > 0.0 && kept < 1.0 && held_[part]) report.converged = false;
  }
  for (int c = 0; c < on_->mesh.n_vertices; ++c) {
    if (on_->mesh.part[at(c)] >= 0 && x_.row(c) != before.row(c)) moves[at(on_->mesh.part[at(c)])] = 1;
  }
  left_ = left;
  carry(moves, x);
}

/// Takes the vertices of these parts of the mesh to where the cage has them.
void CageMethod::carry(const std::vector<char>& parts, Points& x) const {
  std::vector<char> moves(at(on_->cage.triangles.rows()));
  for (std::size_t t = 0; t < moves.size(); ++t)
    moves[t] = parts[at(on_->mesh.part[at(on_->cage.triangles(static_cast<Eigen::Index>(t), 0))])];
  const std::vector<std::complex<double>> turns = turns_at(x_, left_);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Place& place = on_->cage.places[at(v)];
    if (place.triangle < 0 || !moves[at(place.triangle)]) continue;
    x.row(v) = carried(place, on_->cage.triangles, x_);
    if (!turns.empty()) x.row(v) += beside(v, turns);
  }
}

}  // namespace planar
