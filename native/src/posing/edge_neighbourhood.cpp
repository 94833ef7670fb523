// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/edge_neighbourhood.h"

#include <algorithm>

#include "base/complex_rows.h"
#include "base/index.h"
#include "energy/cotangent_weights.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

/// A neighbourhood while its corners are gathered: `fit` is where they are, relative to the edge's start.
void add_triangle(const RestOf& rest_of, int triangle, int a, int b, int corner, EdgeNeighbourhood& hood) {
  if (hood.n_vertices == 4) return;
  const auto point = [&](int v) { return complex_point(rest_of(triangle, v).transpose()); };
  const Complex start = point(a), side = point(b) - start, arm = point(corner) - start;
  if (hood.n_vertices == 0) {
    hood = {{a, b, corner, 0}, 3, side, {0.0, side, arm, 0.0}};
    return;
  }
  // From this triangle's frame to that of the first one: no turn if they are the same.
  const bool same = side == hood.edge || side == 0.0;
  hood.vertex[3] = corner;
  hood.fit[3] = same ? arm : arm * (hood.edge / side);
  hood.n_vertices = 4;
}

void fit_similarity(EdgeNeighbourhood& hood) {
  Complex mean = 0.0;
  for (std::size_t m = 0; m < hood.n_vertices; ++m) mean += hood.fit[m];
  mean /= static_cast<double>(hood.n_vertices);
  double sum = 0.0;
  for (std::size_t m = 0; m < hood.n_vertices; ++m) sum += std::norm(hood.fit[m] -= mean);
  if (sum == 0.0) return;  // all in one place: T = 0
  for (std::size_t m = 0; m < hood.n_vertices; ++m) hood.fit[m] = hood.edge * std::conj(hood.fit[m]) / sum;
}

}  // namespace

std::vector<EdgeNeighbourhood> edge_neighbourhoods(const Mesh& mesh, const RestOf& rest_of) {
  std::vector<EdgeNeighbourhood> hoods(mesh.edges.size(), EdgeNeighbourhood{});
  hoods.reserve(mesh.edges.size() + mesh.braces.size());
  for (int t = 0; t < static_cast<int>(mesh.triangles.rows()); ++t) {
    for (int c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax({mesh.triangles(t, (c + 1) % 3), mesh.triangles(t, (c + 2) % 3)});
      add_triangle(rest_of, t, a, b, mesh.triangles(t, c), hoods[at(mesh.find_edge(a, b))]);
    }
  }
  for (const auto& [corner, a, b] : mesh.braces) {
    add_triangle(rest_of, -1, a, b, corner, hoods.emplace_back());
  }
  for (EdgeNeighbourhood& hood : hoods) fit_similarity(hood);
  return hoods;
}

std::vector<std::array<int, 2>> couplings(const std::vector<EdgeNeighbourhood>& hoods) {
  std::vector<std::array<int, 2>> result;
  for (const EdgeNeighbourhood& hood : hoods) {
    for (std::size_t m = 0; m < hood.n_vertices; ++m) {
      for (std::size_t n = 0; n < m; ++n) result.push_back({hood.vertex[m], hood.vertex[n]});
    }
  }
  return result;
}

Eigen::VectorXd edge_weights(const Mesh& mesh, const RestOf& rest_of, ArapWeights weights,
                             const Eigen::VectorXd& stiffness) {
  return weights == ArapWeights::uniform ? uniform_weights(mesh, stiffness)
                                         : cotangent_weights(mesh, rest_of, stiffness);
}

}  // namespace planar
