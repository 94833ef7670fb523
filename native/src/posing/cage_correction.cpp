// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/cage_correction.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/complex_rows.h"
#include "base/index.h"

namespace planar {

namespace {

constexpr double reach = 0.3;  // of the size: where what a correction says no longer holds

/// Σ over the vertices of the mesh of what belongs to them, by their weights in the cage.
Points restricted(const Cage& cage, const Points& values) {
  Points result = Points::Zero(cage.rest.rows(), 2);
  for (Eigen::Index v = 0; v < values.rows(); ++v) {
    const Place& place = cage.places[at(v)];
    if (place.triangle < 0) continue;
    const int* corner = cage.triangles.data() + 3 * place.triangle;
    result.row(corner[0]) += (1.0 - place.first - place.second) * values.row(v);
    result.row(corner[1]) += place.first * values.row(v);
    result.row(corner[2]) += place.second * values.row(v);
  }
  return result;
}

}  // namespace

CageCorrection::CageCorrection(const Cage& cage, const Mesh& mesh, const RestEnergy& energy,
                               const RestEnergy& dense_energy, const Points& fitted, const Points& x) {
  Points dense;
  energy.gradient(fitted, loads_);
  dense_energy.gradient(x, dense);
  loads_ -= restricted(cage, dense);
  if (!loads_.allFinite()) {
    loads_.resize(0, 2);
    return;
  }
  for (int v = 0; v < mesh.n_vertices; ++v) {
    if (mesh.part[at(v)] < 0) loads_.row(v).setZero();
  }
  fitted_ = fitted;
}

std::vector<double> CageCorrection::shares_at(const Mesh& mesh, const Points& x, double size) const {
  std::vector<double> furthest(at(mesh.n_parts));
  for (int v = 0; v < mesh.n_vertices; ++v) {
    const int part = mesh.part[at(v)];
    if (part >= 0) furthest[at(part)] = std::max(furthest[at(part)], (x.row(v) - fitted_.row(v)).norm());
  }
  for (double& way : furthest) way = std::max(0.0, 1.0 - way / (reach * size));
  return furthest;
}

Points CageCorrection::loads_at(const Mesh& mesh, const Points& x, const std::vector<double>& shares) const {
  using Complex = std::complex<double>;
  std::vector<Complex> turn(at(mesh.n_vertices));
  for (const auto& [a, b] : mesh.edges) {
    const Complex product = (complex_row(x, b) - complex_row(x, a)) *
                            std::conj(complex_row(fitted_, b) - complex_row(fitted_, a));
    turn[at(a)] += product;
    turn[at(b)] += product;
  }
  Points result = Points::Zero(x.rows(), 2);
  for (int v = 0; v < mesh.n_vertices; ++v) {
    const double length = std::abs(turn[at(v)]);
    if (!(length > 0.0)) continue;
    const Complex load = shares[at(mesh.part[at(v)])] / length * turn[at(v)] * complex_row(loads_, v);
    result.row(v) << load.real(), load.imag();
  }
  return result;
}

}  // namespace planar
