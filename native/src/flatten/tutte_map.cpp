// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/tutte_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/index.h"
#include "flatten/laplacian.h"
#include "flatten/shortest_paths.h"
#include "mesh/triangle_shape.h"

namespace planar {

namespace {

// Of a triangle's area on the surface. Descents go well from far less; below 1e-3 the rest energy repairs.
constexpr double small = 1e-2;

/// The mesh with its holes filled.
struct FilledGraph {
  explicit FilledGraph(const Patch& patch)
      : edges(patch.mesh.edges), length(patch.length), n_vertices(at(patch.mesh.n_vertices)) {
    for (std::size_t hole = 1; hole < patch.loops.size(); ++hole, ++n_vertices) {
      const double radius = patch.length_of(patch.loops[hole]) / (2.0 * std::numbers::pi);
      for (const int v : patch.loops[hole]) {
        edges.push_back({v, static_cast<int>(n_vertices)});
        length.push_back(radius);
      }
    }
    inside.resize(n_vertices);
    for (const auto& [a, b] : edges) inside[at(a)] = inside[at(b)] = 1;
    for (const int v : patch.loops[0]) inside[at(v)] = 0;
  }

  std::vector<std::array<int, 2>> edges;
  std::vector<double> length;
  std::size_t n_vertices;
  std::vector<char> inside;  ///< a flag a vertex: not on the outer boundary
};

Points boundary_on_circle(const Patch& patch, Eigen::Index n_vertices) {
  Points x = Points::Zero(n_vertices, 2);
  const std::vector<int>& loop = patch.loops[0];
  const double radius = std::sqrt(patch.area / std::numbers::pi), whole = patch.length_of(loop);
  // Edges without length are given some.
  constexpr double evenly = 1e-3;
  double way = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double share =
        (1.0 - evenly) * way / whole + evenly * static_cast<double>(i) / static_cast<double>(loop.size());
    const double angle = 2.0 * std::numbers::pi * share;
    x.row(loop[i]) << radius * std::cos(angle), radius * std::sin(angle);
    way += patch.length[at(patch.mesh.find_edge(loop[i], loop[(i + 1) % loop.size()]))];
  }
  return x;
}

/// The least of the triangles' areas in x, over what they are on the surface.
double least_scale(const Patch& patch, const Points& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < patch.corners.size(); ++t) {
    if (patch.flat[static_cast<Eigen::Index>(t)]) continue;
    const double scale = doubled_area(x, patch.mesh.triangles.data() + 3 * t) / (2.0 * patch.area_of(t));
    least = std::min(least, scale);
  }
  return least;
}

}  // namespace

Points tutte_map(const Patch& patch) {
  const FilledGraph graph(patch);
  const auto n = static_cast<Eigen::Index>(graph.n_vertices);
  const Points no_force = Points::Zero(n, 2);
  Points x = boundary_on_circle(patch, n);
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(graph.edges.size()));
  Laplacian(graph.edges, weight, graph.inside).solve(no_force, x);
  const double least = least_scale(patch, x);
  if (least < small) {
    const ShortestPaths paths(patch.loops[0], graph.n_vertices, graph.edges, graph.length);
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      const auto [a, b] = graph.edges[e];
      const bool on_path = paths.before[at(a)] == b || paths.before[at(b)] == a;
      if (!on_path) weight[static_cast<Eigen::Index>(e)] = 1.0 / (paths.most_edges * paths.most_edges);
    }
    Points other = x;
    Laplacian(graph.edges, weight, graph.inside).solve(no_force, other);
    if (least_scale(patch, other) > least) x = std::move(other);
  }
  return x.topRows(patch.mesh.n_vertices);
}

}  // namespace planar
