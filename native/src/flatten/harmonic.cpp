// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/harmonic.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "base/index.h"
#include "energy/cotangent_weights.h"
#include "flatten/laplacian.h"
#include "mesh/mesh.h"

namespace planar {

struct Harmonic::System {
  Eigen::VectorXi held;
  Eigen::Index n_vertices;
  Laplacian laplacian;
};

namespace {

/// A flag a vertex: it is not held, and its part has a vertex that is.
std::vector<char> free_vertices(const Mesh& mesh, const Eigen::VectorXi& held) {
  std::vector<char> anchored(at(mesh.n_parts), 0), stays(at(mesh.n_vertices), 0), free(stays);
  for (Eigen::Index i = 0; i < held.rows(); ++i) {
    require_index("held", i, "vertex", held[i], mesh.n_vertices);
    if (stays[at(held[i])] != 0) {
      throw std::invalid_argument(row_of("held", i) + "vertex " + std::to_string(held[i]) +
                                  " is named twice");
    }
    stays[at(held[i])] = 1;
    if (mesh.part[at(held[i])] >= 0) anchored[at(mesh.part[at(held[i])])] = 1;
  }
  for (std::size_t v = 0; v < free.size(); ++v) {
    const int part = mesh.part[v];
    free[v] = static_cast<char>(part >= 0 && stays[v] == 0 && anchored[at(part)] != 0);
  }
  return free;
}

}  // namespace

Harmonic::Harmonic(const Points& rest, const Triangles& triangles, const Eigen::VectorXi& held) {
  require_mesh("rest", rest, triangles);
  require_triangles(rest.rows(), triangles);

  const Mesh mesh(rest.rows(), triangles);
  const std::vector<char> free = free_vertices(mesh, held);
  const RestOf rest_of = [&rest](int, int v) -> Eigen::Vector2d { return rest.row(v).transpose(); };
  Laplacian laplacian(mesh.edges, cotangent_weights(mesh, rest_of), free);
  system_ = std::make_unique<System>(System{held, rest.rows(), std::move(laplacian)});
}

Harmonic::Harmonic(Harmonic&&) noexcept = default;
Harmonic& Harmonic::operator=(Harmonic&&) noexcept = default;
Harmonic::~Harmonic() = default;

Eigen::VectorXd Harmonic::spread(const Eigen::VectorXd& values) const {
  const System& system = *system_;
  require_rows("values", values.rows(), system.held.rows(), "vertex of held");
  require_finite_rows("values", values);
  Points x = Points::Zero(system.n_vertices, 2);  // what the Laplacian moves are points
  for (Eigen::Index i = 0; i < values.rows(); ++i) x(system.held[i], 0) = values[i];
  system.laplacian.solve(Points::Zero(system.n_vertices, 2), x);
  return x.col(0);
}

}  // namespace planar
