// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "planar/types.h"

namespace planar {

/// Places and edge vectors as complex numbers: a row a vertex or an edge, a column a frame.
using ComplexRows = Eigen::Array<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What in-betweening needs to know of a shape: its edges and which parts they connect. Nothing depends on
/// positions.
struct EdgeGraph {
  /// The sides of the triangles, each once.
  /// \throw std::invalid_argument as Mesh, or no triangles
  EdgeGraph(Eigen::Index n_vertices, const Triangles& triangles);

  /// Any edges; contours and meshes without their faces are such.
  /// \throw std::invalid_argument no edges, or naming the row of `edges` that is out of range or names a
  /// vertex twice
  EdgeGraph(Eigen::Index n_vertices, const Edges& edges);

  std::size_t vertex_count() const { return static_cast<std::size_t>(n_vertices); }

  /// e of edge i at x: from its first vertex to its second.
  std::complex<double> vector(std::size_t i, const Points& x) const {
    const auto [a, b] = edges[i];
    return {x(b, 0) - x(a, 0), x(b, 1) - x(a, 1)};
  }

  int n_vertices;
  int n_parts;
  Triangles triangles;  ///< none in a graph made of edges
  std::vector<std::array<int, 2>> edges;
  std::vector<int> part;  ///< of a vertex, numbered from 0 in order of the vertices; -1: isolated
};

}  // namespace planar
