// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/weighted_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.h"
#include "mesh/edge_graph.h"

namespace planar {

namespace {

// A short edge counts no more than one of this length squared, over the area, would, or of this length, over
// the mean.
constexpr double shortest = 1e-3;

double area(const Coordinates& rest, const int* corner) {
  const Eigen::RowVectorXd a = rest.row(corner[1]) - rest.row(corner[0]);
  const Eigen::RowVectorXd b = rest.row(corner[2]) - rest.row(corner[0]);
  const double dot = a.dot(b);
  return 0.5 * std::sqrt(std::max(0.0, a.squaredNorm() * b.squaredNorm() - dot * dot));
}

double length(const Coordinates& rest, const std::array<int, 2>& edge) {
  return (rest.row(edge[0]) - rest.row(edge[1])).norm();
}

}  // namespace

WeightedEdges uniform_edges(Eigen::Index n_vertices, const Elements& elements) {
  EdgeGraph graph =
      std::visit([n_vertices](const auto& rows) { return EdgeGraph(n_vertices, rows); }, elements);
  for (auto& [a, b] : graph.edges) {
    if (a > b) std::swap(a, b);
  }
  std::sort(graph.edges.begin(), graph.edges.end());
  graph.edges.erase(std::unique(graph.edges.begin(), graph.edges.end()), graph.edges.end());
  const auto n = static_cast<Eigen::Index>(graph.edges.size());
  return {std::move(graph.edges), Eigen::VectorXd::Ones(n)};
}

WeightedEdges area_edges(const Coordinates& rest, const Elements& elements) {
  WeightedEdges result = uniform_edges(rest.rows(), elements);
  result.weight.setZero();
  const auto n = result.weight.size();
  if (const auto* triangles = std::get_if<Triangles>(&elements)) {
    for (Eigen::Index t = 0; t < triangles->rows(); ++t) {
      const double a = area(rest, triangles->data() + 3 * t);
      if (!(a > 0.0)) continue;
      for (int c = 0; c < 3; ++c) {
        const std::array<int, 2> side{std::min((*triangles)(t, c), (*triangles)(t, (c + 1) % 3)),
                                      std::max((*triangles)(t, c), (*triangles)(t, (c + 1) % 3))};
        const double squared = length(rest, side) * length(rest, side);
        const auto place = std::lower_bound(result.edge.begin(), result.edge.end(), side);
        result.weight[place - result.edge.begin()] += a / (3.0 * std::max(squared, shortest * a));
      }
    }
    return result;
  }
  double total = 0.0;
  for (const auto& edge : result.edge) total += length(rest, edge);
  const double mean = total / static_cast<double>(n);
  for (Eigen::Index e = 0; e < n; ++e) {
    if (mean > 0.0) result.weight[e] = mean / std::max(length(rest, result.edge[at(e)]), shortest * mean);
  }
  return result;
}

}  // namespace planar
