// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "planar/types.h"

namespace planar {

/// Connectivity of a triangle mesh; nothing here depends on positions. Any set of triangles is a mesh:
/// several parts, holes, isolated vertices, edges with more than two triangles and parts that meet in one
/// vertex are all allowed.
struct Mesh {
  /// \throw std::invalid_argument naming the row of `triangles` that is out of range or names a vertex twice
  Mesh(Eigen::Index n_vertices, Triangles triangles);

  int n_vertices;
  int n_parts;
  Triangles triangles;
  std::vector<std::array<int, 2>> edges;  ///< each once, smaller vertex first, in ascending order
  std::vector<int> part;  ///< of a vertex, numbered from 0 in order of the vertices; -1: isolated

  /// A vertex whose part has a boundary (an edge with one triangle; rims of holes count) and which is not on
  /// it.
  std::vector<char> interior;

  /// Triangles (vertex, neighbour, neighbour) missing between the fans of a vertex where pieces meet in that
  /// vertex alone.
  std::vector<std::array<int, 3>> braces;

  /// Row of `edges` with these two vertices, or -1.
  int find_edge(int a, int b) const;

 private:
  std::vector<int> first_edge_;  ///< of the edges whose smaller vertex is i, n+1 entries
};

/// Where triangle t has its corner v, a vertex, at rest. Triangles need not fit together: each may have a
/// frame of its own, as those of a surface in space do.
using RestOf = std::function<Eigen::Vector2d(int t, int v)>;

}  // namespace planar
