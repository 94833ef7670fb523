// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/mesh_matrix.h"

#include <algorithm>

#include "base/index.h"

namespace planar {

namespace {

constexpr int spare_room = 8;

std::vector<int> slots_of(const Mesh& mesh, const std::vector<int>& kept) {
  std::vector<int> slot(at(mesh.n_vertices), -1);
  for (std::size_t i = 0; i < kept.size(); ++i) slot[at(kept[i])] = static_cast<int>(i);
  return slot;
}

}  // namespace

SparsityPattern vertex_graph(const Mesh& mesh, const std::vector<int>& kept,
                             const std::vector<std::array<int, 2>>& links) {
  const std::vector<int> slot = slots_of(mesh, kept);
  std::vector<std::array<int, 2>> edges;
  const auto couple = [&](int a, int b) {
    if (slot[at(a)] >= 0 && slot[at(b)] >= 0) edges.push_back({slot[at(a)], slot[at(b)]});
  };
  for (const auto& edge : mesh.edges) couple(edge[0], edge[1]);
  for (const auto& brace : mesh.braces) couple(brace[1], brace[2]);
  for (const auto& link : links) couple(link[0], link[1]);
  return graph_pattern(static_cast<int>(kept.size()), edges);
}

MeshMatrix::MeshMatrix(const Mesh& mesh, const std::vector<int>& kept,
                       const std::vector<std::array<int, 2>>& links)
    : slot_(slots_of(mesh, kept)) {
  const SparsityPattern graph = vertex_graph(mesh, kept, links);
  matrix_ = doubled_pattern(graph);
  for (const int v : kept) kept_part_.push_back(mesh.part[at(v)]);
  matrix_.value.assign(matrix_.row.size() + spare_room, 0.0);

  const int spare = static_cast<int>(matrix_.row.size());
  const auto add_corners = [&](std::array<int, 3> corner, int triangle) {
    // Fixed corners go last.
    const auto rank = [this, &graph](int v) { return slot(v) < 0 ? graph.size : slot(v); };
    std::sort(corner.begin(), corner.end(), [&rank](int a, int b) { return rank(a) < rank(b); });
    if (slot(corner[0]) < 0) return;
    Element element{corner, {}, {}, {}, {}, triangle, mesh.part[at(corner[0])]};
    constexpr std::array<std::array<int, 2>, 3> sides{{{0, 1}, {0, 2}, {1, 2}}};
    for (std::size_t c = 0; c < 3; ++c) {
      const int i = slot(corner[c]);
      element.diagonal[c] = i < 0 ? spare : matrix_.column_start[at(2 * i)];
      element.diagonal_y[c] = i < 0 ? spare : matrix_.column_start[at(2 * i) + 1];
      const int later = slot(corner[at(sides[c][1])]);
      const int earlier = slot(corner[at(sides[c][0])]);
      element.below[c] = element.below_y[c] = spare;
      if (later >= 0 && earlier >= 0) {
        element.below[c] = find_block(later, earlier);
        const int length = matrix_.column_start[at(2 * earlier) + 1] - matrix_.column_start[at(2 * earlier)];
        element.below_y[c] = element.below[c] + length - 1;
      }
    }
    elements_.push_back(element);
  };
  for (int t = 0; t < static_cast<int>(mesh.triangles.rows()); ++t) {
    add_corners({mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)}, t);
  }
  for (const auto& brace : mesh.braces) add_corners(brace, -1);
}

int MeshMatrix::find_block(int later, int earlier) const {
  const auto begin = matrix_.row.begin() + matrix_.column_start[at(2 * earlier)];
  const auto end = matrix_.row.begin() + matrix_.column_start[at(2 * earlier) + 1];
  return static_cast<int>(std::lower_bound(begin, end, 2 * later) - matrix_.row.begin());
}

void MeshMatrix::add(int a, int b, double value) {
  const auto [earlier, later] = std::minmax({slot(a), slot(b)});
  const int first = find_block(later, earlier);
  const int start = matrix_.column_start[at(2 * earlier)];
  const int start_y = matrix_.column_start[at(2 * earlier) + 1];
  // The column of y misses the entry above its diagonal, so that everything is one entry earlier, and y one
  // row later.
  matrix_.value[at(first)] += value;
  matrix_.value[at(start_y + first - start)] += value;
}

void MeshMatrix::add(int v, const Eigen::Matrix2d& block) {
  const int x = matrix_.column_start[at(2 * slot(v))], y = matrix_.column_start[at(2 * slot(v)) + 1];
  matrix_.value[at(x)] += block(0, 0);
  matrix_.value[at(x) + 1] += block(1, 0);
  matrix_.value[at(y)] += block(1, 1);
}

void MeshMatrix::set_zero() { std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0); }

void MeshMatrix::set_unit_rows(const std::vector<char>& active) {
  for (std::size_t i = 0; i < kept_part_.size(); ++i) {
    if (kept_part_[i] >= 0 && active[at(kept_part_[i])]) continue;
    matrix_.value[at(matrix_.column_start[2 * i])] = 1.0;
    matrix_.value[at(matrix_.column_start[2 * i + 1])] = 1.0;
  }
}

double MeshMatrix::largest() const {
  double result = 0.0;
  for (int k = 0; k < matrix_.size; ++k)
    result = std::max(result, matrix_.value[at(matrix_.column_start[at(k)])]);
  return result;
}

}  // namespace planar
