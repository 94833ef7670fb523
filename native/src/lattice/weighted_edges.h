// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "planar/lattice.h"

namespace planar {

/// Triangles or edges, what a lattice's model is made of.
using Elements = std::variant<Triangles, Edges>;

/// Edges of a model, each once, with their weights.
struct WeightedEdges {
  std::vector<std::array<int, 2>> edge;
  Eigen::VectorXd weight;
};

/// The sides of triangles, or the given edges, all with weight 1.
///
/// \throw std::invalid_argument none, or naming the row that is out of range or names a vertex twice
WeightedEdges uniform_edges(Eigen::Index n_vertices, const Elements& elements);

/// The same such that stretching counts by area: an edge with a third of its triangles' areas over its length
/// squared; without triangles by length: with the mean length over its own. Then no part counts more for
/// being finer.
WeightedEdges area_edges(const Coordinates& rest, const Elements& elements);

}  // namespace planar
