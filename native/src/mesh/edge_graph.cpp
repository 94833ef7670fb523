// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/edge_graph.h"

#include <string>

#include "base/checks.h"
#include "base/disjoint_sets.h"
#include "base/index.h"
#include "mesh/mesh.h"

namespace planar {

EdgeGraph::EdgeGraph(Eigen::Index vertex_count, const Triangles& rows)
    : n_vertices(0), n_parts(0), triangles(rows) {
  if (rows.rows() == 0) throw std::invalid_argument("triangles is empty: a mesh needs at least one triangle");
  Mesh mesh(vertex_count, rows);
  n_vertices = mesh.n_vertices;
  n_parts = mesh.n_parts;
  edges = std::move(mesh.edges);
  part = std::move(mesh.part);
}

EdgeGraph::EdgeGraph(Eigen::Index vertex_count, const Edges& rows) : n_vertices(0), n_parts(0) {
  if (rows.rows() == 0) throw std::invalid_argument("edges is empty: a shape needs at least one edge");
  if (vertex_count > most_rows || rows.rows() > most_rows) {
    throw std::invalid_argument("edges: a shape of this size is not supported");
  }
  n_vertices = static_cast<int>(vertex_count);
  DisjointSets connected(this->vertex_count());
  part.assign(this->vertex_count(), -1);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const int a = rows(i, 0), b = rows(i, 1);
    for (const int vertex : {a, b}) require_index("edges", i, "vertex", vertex, n_vertices);
    if (a == b) throw std::invalid_argument(row_of("edges", i) + "names a vertex twice");
    edges.push_back({a, b});
    connected.join(a, b);
    part[at(a)] = part[at(b)] = 0;
  }
  for (int v = 0; v < n_vertices; ++v) {
    int& number = part[at(v)];
    if (number == -1) continue;
    const int root = connected.find(v);
    number = root == v ? n_parts++ : part[at(root)];
  }
}

}  // namespace planar
