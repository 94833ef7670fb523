// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/checks.h"
#include "base/disjoint_sets.h"
#include "base/index.h"

namespace planar {

namespace {

/// Row i holds the vertices above i that share a triangle with it, once per triangle, ascending.
struct UpperNeighbours {
  std::vector<int> first, vertex;

  UpperNeighbours(int n_vertices, const Triangles& triangles)
      : first(at(n_vertices) + 1), vertex(at(3) * at(triangles.rows())) {
    const auto for_each_side = [&triangles](auto&& visit) {
      for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        for (int c = 0; c < 3; ++c) visit(std::minmax(triangles(t, c), triangles(t, (c + 1) % 3)));
      }
    };
    for_each_side([this](std::pair<int, int> side) { ++first[at(side.first) + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> next(first.begin(), first.end() - 1);
    for_each_side([&](std::pair<int, int> side) { vertex[at(next[at(side.first)]++)] = side.second; });
    for (int i = 0; i < n_vertices; ++i) {
      std::sort(vertex.begin() + first[at(i)], vertex.begin() + first[at(i) + 1]);
    }
  }
};

/// The braces of every vertex where fans of triangles meet in it alone.
std::vector<std::array<int, 3>> find_braces(int n_vertices, const Triangles& triangles) {
  std::vector<int> first(at(n_vertices) + 1);
  for (Eigen::Index i = 0; i < triangles.size(); ++i) ++first[at(triangles.data()[i]) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  // The side opposite to the vertex, for each of its triangles: an edge of the vertex's link.
  std::vector<std::array<int, 2>> link(at(triangles.size()));
  std::vector<int> next(first.begin(), first.end() - 1);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      link[at(next[at(triangles(t, c))]++)] = {triangles(t, (c + 1) % 3), triangles(t, (c + 2) % 3)};
    }
  }
  std::vector<std::array<int, 3>> braces;
  std::vector<int> names;
  for (int v = 0; v < n_vertices; ++v) {
    names.clear();
    for (int i = first[at(v)]; i < first[at(v) + 1]; ++i)
      names.insert(names.end(), link[at(i)].begin(), link[at(i)].end());
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    DisjointSets fans(names.size());
    const auto local = [&names](int u) {
      return static_cast<int>(std::lower_bound(names.begin(), names.end(), u) - names.begin());
    };
    for (int i = first[at(v)]; i < first[at(v) + 1]; ++i)
      fans.join(local(link[at(i)][0]), local(link[at(i)][1]));
    int previous = 0;
    for (int i = 1; i < static_cast<int>(names.size()); ++i) {
      if (fans.find(i) != i) continue;
      braces.push_back({v, names[at(previous)], names[at(i)]});
      previous = i;
    }
  }
  return braces;
}

}  // namespace

Mesh::Mesh(Eigen::Index vertex_count, Triangles rows)
    : n_vertices(static_cast<int>(vertex_count)), n_parts(0), triangles(std::move(rows)) {
  require_triangles(vertex_count, triangles);
  const UpperNeighbours sides(n_vertices, triangles);
  std::vector<char> on_boundary(at(n_vertices));
  DisjointSets connected(at(n_vertices));
  first_edge_.push_back(0);
  for (int a = 0; a < n_vertices; ++a) {
    const auto end = sides.vertex.begin() + sides.first[at(a) + 1];
    for (auto side = sides.vertex.begin() + sides.first[at(a)]; side != end;) {
      const int b = *side;
      const auto after = std::find_if(side, end, [b](int other) { return other != b; });
      if (after - side == 1) on_boundary[at(a)] = on_boundary[at(b)] = 1;
      edges.push_back({a, b});
      connected.join(a, b);
      side = after;
    }
    first_edge_.push_back(static_cast<int>(edges.size()));
  }

  part.assign(at(n_vertices), -1);
  std::vector<char> used(at(n_vertices));
  for (const auto& edge : edges) used[at(edge[0])] = used[at(edge[1])] = 1;
  std::vector<char> has_boundary;
  for (int i = 0; i < n_vertices; ++i) {
    if (!used[at(i)]) continue;
    const int root = connected.find(i);
    part[at(i)] = root == i ? n_parts++ : part[at(root)];
    has_boundary.resize(at(n_parts));
    if (on_boundary[at(i)]) has_boundary[at(part[at(i)])] = 1;
  }
  interior.assign(at(n_vertices), 0);
  for (int i = 0; i < n_vertices; ++i) {
    interior[at(i)] = used[at(i)] && !on_boundary[at(i)] && has_boundary[at(part[at(i)])];
  }
  braces = find_braces(n_vertices, triangles);
}

int Mesh::find_edge(int a, int b) const {
  const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
  const auto end = edges.begin() + first_edge_[at(edge[0]) + 1];
  const auto place = std::lower_bound(edges.begin() + first_edge_[at(edge[0])], end, edge);
  return place != end && *place == edge ? static_cast<int>(place - edges.begin()) : -1;
}

}  // namespace planar
