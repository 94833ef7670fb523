// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/harmonic.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "base/checks.h"
#include "base/index.h"
#include "energy/cotangent_weights.h"
#include "flatten/laplacian.h"
#include "mesh/mesh.h"

namespace planar {

Eigen::VectorXd harmonic(const Points& rest, const Triangles& triangles, const Eigen::VectorXi& held,
                         const Eigen::VectorXd& values) {
  require_mesh("rest", rest, triangles);
  require_triangles(rest.rows(), triangles);
  require_rows("values", values.rows(), held.rows(), "vertex of held");
  require_finite_rows("values", values);

  const Mesh mesh(rest.rows(), triangles);
  std::vector<char> anchored(at(mesh.n_parts), 0), stays(at(mesh.n_vertices), 0), free(stays);
  Points x = Points::Zero(rest.rows(), 2);  // what the Laplacian moves are points
  for (Eigen::Index i = 0; i < held.rows(); ++i) {
    require_index("held", i, "vertex", held[i], rest.rows());
    if (stays[at(held[i])] != 0) {
      throw std::invalid_argument(row_of("held", i) + ": vertex " + std::to_string(held[i]) +
                                  " is named twice");
    }
    stays[at(held[i])] = 1;
    x(held[i], 0) = values[i];
    if (mesh.part[at(held[i])] >= 0) anchored[at(mesh.part[at(held[i])])] = 1;
  }
  for (std::size_t v = 0; v < free.size(); ++v) {
    const int part = mesh.part[v];
    free[v] = static_cast<char>(part >= 0 && stays[v] == 0 && anchored[at(part)] != 0);
  }
  const RestOf rest_of = [&rest](int, int v) -> Eigen::Vector2d { return rest.row(v).transpose(); };
  Laplacian(mesh.edges, cotangent_weights(mesh, rest_of), free).solve(Points::Zero(rest.rows(), 2), x);
  return x.col(0);
}

}  // namespace planar
