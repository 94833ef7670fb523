// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/carried_keys.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/diameter.h"
#include "base/index.h"
#include "cage/refinement.h"
#include "inbetween/inbetween_input.h"
#include "mesh/triangle_shape.h"
#include "posing/upright_patches.h"

namespace planar {

namespace {

constexpr double negligible = 1e-6;  // of the size: what the fit leaves of float32

/// Of key `from`, judging only triangles that lie the same way round in `to`.
Orientation upright_between(const Points& from, const Points& to, const Triangles& triangles) {
  const Orientation all(from, triangles, flat_triangles(from, triangles));
  return {from, triangles, all.flat() || all.flipped(to)};
}

/// A dense vertex as a mean of the cage's.
void add(std::map<int, double>& spot, const Cage& cage, int vertex) {
  const Place& place = cage.places[at(vertex)];
  if (place.triangle < 0) {
    spot[cage.row_of(vertex)] += 1.0;
    return;
  }
  const int* corner = cage.triangles.data() + 3 * place.triangle;
  spot[corner[0]] += 1.0 - place.first - place.second;
  spot[corner[1]] += place.first;
  spot[corner[2]] += place.second;
}

/// Vertices at pins of one handle.
std::vector<int> single_points(const FramePins& pins) {
  std::vector<int> result;
  for (const PinRows& rows : pins.pins) {
    if (rows.size() > 1) continue;
    Eigen::Index corner = 0;
    pins.handles.weights.row(rows[0]).maxCoeff(&corner);
    result.push_back(pins.handles.vertices(rows[0], corner));
  }
  return result;
}

Spot spot_of(const std::map<int, double>& sums) {
  Spot result;
  for (const auto& [vertex, weight] : sums) result.push_back({vertex, weight});
  return result;
}

}  // namespace

std::unique_ptr<CarriedKeys> CarriedKeys::of(const std::vector<Points>& keys, EdgeGraph& graph,
                                             const InbetweenOptions& options, const FramePins* pins) {
  if (!options.cage) return {};
  if (graph.triangles.rows() == 0) throw std::invalid_argument("cage: edges have none; triangles are needed");
  const Points& reference = options.rest.rows() == 0 ? keys[0] : options.rest;
  references_of(keys, options);
  std::optional<Coarse> coarse = coarse_for_cage(reference, graph.triangles, *options.cage);
  if (!coarse) return {};
  if (pins) *coarse = refined_near(reference, *coarse, single_points(*pins));
  return std::make_unique<CarriedKeys>(keys, std::move(graph), options, reference, std::move(*coarse));
}

CarriedKeys::CarriedKeys(const std::vector<Points>& keys, EdgeGraph graph, const InbetweenOptions& options,
                         const Points& reference, Coarse coarse)
    : dense_keys_(keys),
      reference_(reference),
      graph_(std::move(graph)),
      cage_(make_cage(reference, std::move(coarse))),
      mesh_(cage_.rest.rows(), cage_.triangles),
      suspects_(cage_, reference, graph_.triangles),
      dense_part_(at(mesh_.n_parts), -1),
      pinned_(at(reference.rows())) {
  graph_.edges = {};
  for (std::size_t v = 0; v < cage_.places.size(); ++v) {
    const int t = cage_.places[v].triangle;
    if (t >= 0) dense_part_[at(mesh_.part[at(cage_.triangles(t, 0))])] = graph_.part[v];
  }
  const CageFit fit(cage_, mesh_);
  for (const Points& key : keys) {
    cage_keys_.push_back(fit.fit(key));
    beside_.emplace_back(cage_, cage_keys_.back(), key, negligible * diameter(key));
  }
  for (std::size_t k = 0; k + 1 < keys.size(); ++k)
    upright_.push_back(upright_between(keys[k], keys[k + 1], graph_.triangles));
  turns_ = turns_of(graph_, keys, options);
}

InbetweenOptions CarriedKeys::options(const InbetweenOptions& dense) const {
  InbetweenOptions result = dense;
  if (dense.rest.rows() != 0) result.rest = cage_.rest;
  result.anchors.clear();
  result.joints.clear();
  result.pins = {};
  result.turns = turns_(Eigen::all, dense_part_);
  return result;
}

Ties CarriedKeys::ties(const Eigen::VectorXi& anchor, const Edges& joints) const {
  std::vector<char> anchored(at(graph_.n_parts));
  std::map<int, double> sums;
  for (const int v : anchor) {
    if (graph_.part[at(v)] < 0) continue;
    add(sums, cage_, v);
    anchored[at(graph_.part[at(v)])] = 1;
  }
  for (int v = 0; v < graph_.n_vertices; ++v) {
    if (graph_.part[at(v)] >= 0 && !anchored[at(graph_.part[at(v)])]) add(sums, cage_, v);
  }
  Ties result;
  result.anchor = spot_of(sums);
  for (Eigen::Index i = 0; i < joints.rows(); ++i) {
    std::array<Spot, 2> joint;
    for (int side = 0; side < 2; ++side) {
      std::map<int, double> point;
      add(point, cage_, joints(i, side));
      joint[at(side)] = spot_of(point);
    }
    result.joints.push_back(joint);
  }
  return result;
}

void CarriedKeys::carry(FramePins& pins) {
  const Points& rest = reference_;
  for (const int v : pins.handles.vertices.reshaped()) pinned_[at(v)] = 1;
  for (JointPoints& joints : pins.joints)
    joints = {caged(joints.carrying, cage_, rest), caged(joints.carried, cage_, rest)};
  pins.beyond = [this, dense = pins.handles, on_cage = caged(pins.handles, cage_, rest)](
                    const Points& x, std::size_t k, double u) -> Points {
    const Spots spots(*this, x, k, u);
    Points result = -on_cage.positions(x);
    for (Eigen::Index row = 0; row < result.rows(); ++row) {
      for (int c = 0; c < 3; ++c) {
        const double weight = dense.weights(row, c);
        if (weight != 0.0) result.row(row) += weight * spots.of(dense.vertices(row, c));
      }
    }
    return result;
  };
  pins.handles = caged(pins.handles, cage_, rest);
  pins.part = parts_of(pins.handles, mesh_.part);
  pins.triangles = triangles_of(cage_.triangles, mesh_.part, pins.part);
}

std::vector<int> CarriedKeys::parts(const std::vector<int>& of_cage) const {
  std::vector<int> result;
  result.reserve(of_cage.size());
  for (const int part : of_cage) result.push_back(dense_part_[at(part)]);
  std::sort(result.begin(), result.end());
  return result;
}

CarriedKeys::Spots::Spots(const CarriedKeys& of, const Points& x, std::size_t k, double u)
    : of_(of),
      x_(x),
      share_(std::clamp(u, 0.0, 1.0)),
      before_(of.beside_[k]),
      after_(of.beside_[k + 1]),
      turned_before_(before_.turns_to(of.cage_, x)),
      turned_after_(after_.turns_to(of.cage_, x)) {}

Eigen::RowVector2d CarriedKeys::Spots::of(int vertex) const {
  const Cage& cage = of_.cage_;
  const Place& place = cage.places[at(vertex)];
  if (place.triangle < 0) return x_.row(cage.row_of(vertex));
  Eigen::RowVector2d p = planar::carried(place, cage.triangles, x_);
  if (!turned_before_.empty()) p += (1.0 - share_) * before_.of(cage, vertex, turned_before_);
  if (!turned_after_.empty()) p += share_ * after_.of(cage, vertex, turned_after_);
  return p;
}

Points CarriedKeys::carried(const Points& x, std::size_t k, double u) const {
  const Spots spots(*this, x, k, u);
  Points result(graph_.n_vertices, 2);
  for (int v = 0; v < graph_.n_vertices; ++v) result.row(v) = spots.of(v);
  const std::size_t nearest = u < 0.5 ? k : k + 1;
  turn_upright(dense_keys_[nearest], upright_[k], Eigen::RowVector2d::Zero(), {}, pinned_,
               suspects_.at(cage_, x, !spots.are_the_cages()), result);
  return result;
}

}  // namespace planar
