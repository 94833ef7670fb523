// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/pin_holder.h"

#include <cmath>

#include "base/complex_rows.h"
#include "base/diameter.h"
#include "base/index.h"
#include "energy/rigid_fit.h"
#include "mesh/triangle_shape.h"

namespace planar {

namespace {

constexpr double step = 0.02;      // of the diameter: how far handles go at once
constexpr int few_iterations = 2;  // on the way

}  // namespace

std::vector<int> parts_of(const Handles& handles, const std::vector<int>& vertex_part) {
  std::vector<int> parts;
  for (Eigen::Index row = 0; row < handles.size(); ++row) {
    Eigen::Index corner = 0;
    handles.weights.row(row).maxCoeff(&corner);  // those without weight may be any vertices
    parts.push_back(vertex_part[at(handles.vertices(row, corner))]);
  }
  return parts;
}

PinHolder::PinHolder(const Points& size, const Triangles& triangles)
    : mesh_(size.rows(), triangles),
      orientation_(size, triangles, flat_triangles(size, triangles)),
      method_(size, triangles, orientation_, {}),
      size_(diameter(size)) {}

void PinHolder::begin(const Points& frame) {
  orientation_ = Orientation(frame, mesh_.triangles, flat_triangles(frame, mesh_.triangles));
  method_.set_rest(frame);
}

void PinHolder::move_rigidly(const Handles& handles, const Points& places, Points& x) const {
  const Points from = handles.positions(x);
  const std::vector<int> parts = parts_of(handles, mesh_.part);
  std::vector<PointPair> pairs;
  std::vector<char> moves(at(mesh_.n_parts));
  for (Eigen::Index row = 0; row < handles.size(); ++row) {
    const int part = parts[at(row)];
    if (part < 0) continue;
    pairs.push_back({part, 1.0, complex_row(from, row), complex_row(places, row)});
    if (from.row(row) != places.row(row)) moves[at(part)] = 1;
  }
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, pairs);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int part = mesh_.part[at(v)];
    if (part < 0 || !moves[at(part)]) continue;
    const std::complex<double> p = motions[at(part)].at(complex_row(x, v));
    x.row(v) << p.real(), p.imag();
  }
}

void PinHolder::hold(const HandleSet& set, const Points& places, Points& x) {
  method_.set_handles(set);
  move_rigidly(set.handles, places, x);
  const Points from = set.handles.positions(x), way = places - from;
  const double steps = std::ceil(way.rowwise().norm().maxCoeff() / (step * size_));
  Report report;
  for (int i = 1; i < steps; ++i) {
    method_.settle_within(few_iterations, {}, from + (i / steps) * way, x, report);
  }
  method_.settle(places, x, report);
}

}  // namespace planar
