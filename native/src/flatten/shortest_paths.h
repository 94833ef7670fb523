// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

namespace planar {

/// The shortest paths along the edges of a graph from the nearest of some roots to each vertex.
struct ShortestPaths {
  /// \param length not below 0, of each edge
  ShortestPaths(const std::vector<int>& roots, std::size_t n_vertices,
                const std::vector<std::array<int, 2>>& edges, const std::vector<double>& length);

  std::vector<double> distance;  ///< of a vertex; infinite where there is no path
  std::vector<int> before;       ///< the vertex before on the path, or -1
  int most_edges = 0;            ///< of one path
};

}  // namespace planar
