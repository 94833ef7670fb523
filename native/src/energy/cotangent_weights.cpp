// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/cotangent_weights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.h"

namespace planar {

namespace {

constexpr double least_thickness = 1e-5;  // of the longest side, as in energy/killing_energy.cpp
constexpr double least_weight = 1e-9;     // beside 0.58 of an edge between equilateral triangles

double stiffness_of(const Eigen::VectorXd& stiffness, Eigen::Index t) {
  return stiffness.size() != 0 ? stiffness[t] : 1.0;
}

double cotangent(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
  const double cross = std::abs(a.x() * b.y() - a.y() * b.x());
  return longest > 0.0 ? a.dot(b) / std::max(cross, least_thickness * longest) : 0.0;
}

}  // namespace

Eigen::VectorXd cotangent_weights(const Mesh& mesh, const RestOf& rest_of, const Eigen::VectorXd& stiffness) {
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.edges.size()));
  for (int t = 0; t < static_cast<int>(mesh.triangles.rows()); ++t) {
    std::array<Eigen::Vector2d, 3> p;
    for (int c = 0; c < 3; ++c) p[at(c)] = rest_of(t, mesh.triangles(t, c));
    for (int c = 0; c < 3; ++c) {
      const int next = (c + 1) % 3, last = (c + 2) % 3;
      weight[mesh.find_edge(mesh.triangles(t, next), mesh.triangles(t, last))] +=
          0.5 * stiffness_of(stiffness, t) * cotangent(p[at(next)] - p[at(c)], p[at(last)] - p[at(c)]);
    }
  }
  return weight.cwiseMax(least_weight);
}

Eigen::VectorXd uniform_weights(const Mesh& mesh, const Eigen::VectorXd& stiffness) {
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.edges.size()));
  Eigen::VectorXd count = weight;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int edge = mesh.find_edge(mesh.triangles(t, c), mesh.triangles(t, (c + 1) % 3));
      weight[edge] += stiffness_of(stiffness, t);
      count[edge] += 1.0;
    }
  }
  return weight.cwiseQuotient(count);
}

}  // namespace planar
