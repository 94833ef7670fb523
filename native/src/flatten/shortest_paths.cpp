// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/shortest_paths.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "base/index.h"

namespace planar {

ShortestPaths::ShortestPaths(const std::vector<int>& roots, std::size_t n_vertices,
                             const std::vector<std::array<int, 2>>& edges, const std::vector<double>& length)
    : distance(n_vertices, std::numeric_limits<double>::infinity()), before(n_vertices, -1) {
  std::vector<std::vector<std::pair<int, double>>> neighbours(n_vertices);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    neighbours[at(a)].emplace_back(b, length[e]);
    neighbours[at(b)].emplace_back(a, length[e]);
  }
  using Reached = std::pair<double, int>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  for (const int root : roots) {
    distance[at(root)] = 0.0;
    open.emplace(0.0, root);
  }
  std::vector<int> n_edges(n_vertices, 0);
  while (!open.empty()) {
    const auto [way, v] = open.top();
    open.pop();
    if (way > distance[at(v)]) continue;
    most_edges = std::max(most_edges, n_edges[at(v)]);
    for (const auto& [u, step] : neighbours[at(v)]) {
      if (!(way + step < distance[at(u)])) continue;
      distance[at(u)] = way + step;
      before[at(u)] = v;
      n_edges[at(u)] = n_edges[at(v)] + 1;
      open.emplace(way + step, u);
    }
  }
}

}  // namespace planar
