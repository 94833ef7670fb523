// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/cage.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/index.h"
#include "cage/coarsening.h"

namespace planar {
namespace {

/// Of the mean diagonal: a spring along each edge, for how far its ends are from where the fit begins. Has
/// vertices follow their neighbours where hardly a dense one depends on them.
constexpr double regularisation = 1e-9;
/// Solves of the fit, each for what the one before leaves: takes out what the regularisation does.
constexpr int rounds = 2;

std::array<double, 3> weights_of(const Place& place) {
  return {1.0 - place.first - place.second, place.first, place.second};
}

}  // namespace

Place place_in(const Points& rest, const Triangles& triangles, int triangle,
               const Eigen::RowVector2d& point) {
  const int* corner = triangles.data() + 3 * triangle;
  const Eigen::RowVector2d a = rest.row(corner[0]);
  const Eigen::RowVector2d u = rest.row(corner[1]) - a, v = rest.row(corner[2]) - a, p = point - a;
  const double area = u.x() * v.y() - u.y() * v.x();
  if (area == 0.0) return {triangle, 0.0, 0.0};
  return {triangle, (p.x() * v.y() - p.y() * v.x()) / area, (u.x() * p.y() - u.y() * p.x()) / area};
}

std::optional<Coarse> coarse_for_cage(const Points& rest, const Triangles& triangles, int wished) {
  if (rest.rows() <= wished) return {};
  Coarse coarse = coarsened(rest, triangles, wished);
  if (2 * coarse.points.rows() > rest.rows()) return {};
  return coarse;
}

Cage make_cage(const Points& rest, Coarse coarse) {
  Cage cage{std::move(coarse.points), std::move(coarse.triangles), {}, std::move(coarse.origins)};
  const std::vector<int>& owner = coarse.triangle_of;
  cage.places.reserve(owner.size());
  for (std::size_t v = 0; v < owner.size(); ++v) {
    cage.places.push_back(
        owner[v] < 0 ? Place{-1, 0.0, 0.0}
                     : place_in(cage.rest, cage.triangles, owner[v], rest.row(static_cast<Eigen::Index>(v))));
  }
  const auto isolated = std::find(owner.begin(), owner.end(), -1);
  if (isolated != owner.end()) {
    const auto v = static_cast<int>(isolated - owner.begin());
    cage.rest.conservativeResize(cage.rest.rows() + 1, 2);
    cage.rest.bottomRows(1) = rest.row(v);
    cage.origins.push_back({v, -1, -1});
  }
  return cage;
}

CageFit::CageFit(const Cage& cage, const Mesh& mesh)
    : cage_(cage),
      solver_(SparseSolver::create(default_backend())),
      unknowns_(*solver_, mesh.edges, std::vector<char>(at(mesh.n_vertices), 1)) {
  SymmetricMatrix matrix = unknowns_.zero<double>();
  for (const Place& place : cage.places) {
    if (place.triangle < 0) continue;
    const std::array<double, 3> weight = weights_of(place);
    for (int a = 0; a < 3; ++a) {
      const int i = unknowns_.slot[at(cage.triangles(place.triangle, a))];
      for (int b = 0; b < 3; ++b) {
        const int j = unknowns_.slot[at(cage.triangles(place.triangle, b))];
        if (i >= j) matrix.value[at(matrix.find(i, j))] += weight[at(a)] * weight[at(b)];
      }
    }
  }
  double mean = 0.0;
  for (int i = 0; i < unknowns_.size; ++i) mean += matrix.value[at(matrix.find(i, i))] / unknowns_.size;
  const double stiffness = regularisation * mean;
  for (const auto& [a, b] : mesh.edges) {
    const auto [j, i] = std::minmax(unknowns_.slot[at(a)], unknowns_.slot[at(b)]);
    matrix.value[at(matrix.find(i, j))] -= stiffness;
    matrix.value[at(matrix.find(i, i))] += stiffness;
    matrix.value[at(matrix.find(j, j))] += stiffness;
  }
  for (int i = 0; i < unknowns_.size; ++i) {
    double& diagonal = matrix.value[at(matrix.find(i, i))];
    if (diagonal == 0.0) diagonal = 1.0;  // isolated
  }
  solver_->analyze(matrix);
  solver_->factorize(matrix);
}

Points CageFit::fit(const Points& x) const {
  Points result(unknowns_.size, 2);
  for (Eigen::Index c = 0; c < result.rows(); ++c) {
    const auto [source, a, b] = cage_.origins[at(c)];
    result.row(c) = source >= 0 ? x.row(source).eval() : (0.5 * (result.row(a) + result.row(b))).eval();
  }
  RightSides right(unknowns_.size, 2);
  for (int round = 0; round < rounds; ++round) {
    right.setZero();
    for (std::size_t v = 0; v < cage_.places.size(); ++v) {
      const Place& place = cage_.places[v];
      if (place.triangle < 0) continue;
      const Eigen::RowVector2d left =
          x.row(static_cast<Eigen::Index>(v)) - carried(place, cage_.triangles, result);
      const std::array<double, 3> weight = weights_of(place);
      for (int c = 0; c < 3; ++c)
        right.row(unknowns_.slot[at(cage_.triangles(place.triangle, c))]) += weight[at(c)] * left;
    }
    solver_->solve(right);
    for (int c = 0; c < static_cast<int>(result.rows()); ++c)
      result.row(c) += right.row(unknowns_.slot[at(c)]);
  }
  return result;
}

}  // namespace planar
