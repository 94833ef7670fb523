// SPDX-License-Identifier: GPL-3.0-or-later
#include "killing_energy.h"

#include <algorithm>
#include <cmath>

namespace planar {

namespace {

constexpr double least_area = 1e-5;       // of the longest edge squared
constexpr double brace_stiffness = 1e-3;  // of a triangle in its place
constexpr double anchor = 1e-2;           // of a flat triangle's springs
constexpr int spare_room = 8;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::vector<int> places(const Mesh& mesh, const std::vector<int>& kept) {
  std::vector<int> place(at(mesh.n_vertices), -1);
  for (std::size_t i = 0; i < kept.size(); ++i) place[at(kept[i])] = static_cast<int>(i);
  return place;
}

}  // namespace

SymmetricMatrix vertex_graph(const Mesh& mesh, const std::vector<int>& kept) {
  const std::vector<int> place = places(mesh, kept);
  SymmetricMatrix graph;
  graph.size = static_cast<int>(kept.size());
  std::vector<std::vector<int>> column(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) column[i].push_back(static_cast<int>(i));
  const auto couple = [&](int a, int b) {
    const auto [i, j] = std::minmax({place[at(a)], place[at(b)]});
    if (i >= 0) column[at(i)].push_back(j);
  };
  for (const auto& edge : mesh.edges) couple(edge[0], edge[1]);
  for (const auto& brace : mesh.braces) couple(brace[1], brace[2]);
  graph.column_start.push_back(0);
  for (auto& rows : column) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    graph.row.insert(graph.row.end(), rows.begin(), rows.end());
    graph.column_start.push_back(static_cast<int>(graph.row.size()));
  }
  return graph;
}

KillingMatrix::KillingMatrix(const Mesh& mesh, const std::vector<int>& kept) : place_(places(mesh, kept)) {
  const SymmetricMatrix graph = vertex_graph(mesh, kept);
  matrix_.size = 2 * graph.size;
  matrix_.column_start.push_back(0);
  for (int j = 0; j < graph.size; ++j) {
    kept_part_.push_back(mesh.part[at(kept[at(j)])]);
    for (int axis = 0; axis < 2; ++axis) {
      for (int p = graph.column_start[at(j)]; p < graph.column_start[at(j) + 1]; ++p) {
        const int i = graph.row[at(p)];
        if (i > j || axis == 0) matrix_.row.push_back(2 * i);
        matrix_.row.push_back(2 * i + 1);
      }
      matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
    }
  }
  matrix_.value.assign(matrix_.row.size() + spare_room, 0.0);

  const int spare = static_cast<int>(matrix_.row.size());
  const auto add_corners = [&](std::array<int, 3> corner, int triangle) {
    // Fixed corners go last.
    const auto rank = [this, &graph](int v) { return place(v) < 0 ? graph.size : place(v); };
    std::sort(corner.begin(), corner.end(), [&rank](int a, int b) { return rank(a) < rank(b); });
    if (place(corner[0]) < 0) return;
    Element element{corner, {}, {}, {}, {}, triangle, mesh.part[at(corner[0])]};
    constexpr std::array<std::array<int, 2>, 3> sides{{{0, 1}, {0, 2}, {1, 2}}};
    for (std::size_t c = 0; c < 3; ++c) {
      const int i = place(corner[c]);
      element.diagonal[c] = i < 0 ? spare : matrix_.column_start[at(2 * i)];
      element.diagonal_y[c] = i < 0 ? spare : matrix_.column_start[at(2 * i) + 1];
      const int later = place(corner[at(sides[c][1])]);
      const int earlier = place(corner[at(sides[c][0])]);
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

int KillingMatrix::find_block(int later, int earlier) const {
  const auto begin = matrix_.row.begin() + matrix_.column_start[at(2 * earlier)];
  const auto end = matrix_.row.begin() + matrix_.column_start[at(2 * earlier) + 1];
  return static_cast<int>(std::lower_bound(begin, end, 2 * later) - matrix_.row.begin());
}

void KillingMatrix::add(int a, int b, double value) {
  const auto [earlier, later] = std::minmax({place(a), place(b)});
  const int first = find_block(later, earlier);
  const int start = matrix_.column_start[at(2 * earlier)];
  const int start_y = matrix_.column_start[at(2 * earlier) + 1];
  // The column of y misses the entry above its diagonal, so that everything is one place earlier, and y one
  // row later.
  matrix_.value[at(first)] += value;
  matrix_.value[at(start_y + first - start)] += value;
}

void KillingMatrix::assemble(const Points& x, const Eigen::VectorXd& stiffness,
                             const std::vector<char>& active) {
  std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0);
  for (const Element& element : elements_) {
    if (!active[at(element.part)]) continue;
    add_element(element, x,
                element.triangle < 0 ? brace_stiffness
                : stiffness.size()   ? stiffness[element.triangle]
                                     : 1.0);
  }
  for (std::size_t i = 0; i < kept_part_.size(); ++i) {
    if (kept_part_[i] >= 0 && active[at(kept_part_[i])]) continue;
    matrix_.value[at(matrix_.column_start[2 * i])] = 1.0;
    matrix_.value[at(matrix_.column_start[2 * i + 1])] = 1.0;
  }
}

void KillingMatrix::add_element(const Element& element, const Points& x, double stiffness) {
  const auto p = [&](std::size_t c) -> Eigen::Vector2d { return x.row(element.vertex[c]); };
  const std::array<Eigen::Vector2d, 3> side{p(2) - p(1), p(0) - p(2), p(1) - p(0)};
  const double longest = std::max({side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm()});
  const double doubled_area = std::abs(side[0].x() * side[1].y() - side[0].y() * side[1].x());
  const double floor = 2.0 * least_area * longest;
  if (!(doubled_area > floor)) add_springs(element, side, 2.0 * least_area * stiffness);
  if (longest == 0.0) return;

  // The gradient of corner c's hat function is its opposite side, turned by 90°, over the doubled area: (a,
  // b) / (2A).
  const double scale = stiffness / (2.0 * std::max(doubled_area, floor));
  double* value = matrix_.value.data();
  for (std::size_t c = 0; c < 3; ++c) {
    const double a = -side[c].y(), b = side[c].x();
    value[element.diagonal[c]] += scale * (4.0 * a * a + 2.0 * b * b);
    value[element.diagonal[c] + 1] += scale * 2.0 * a * b;
    value[element.diagonal_y[c]] += scale * (4.0 * b * b + 2.0 * a * a);
  }
  constexpr std::array<std::array<std::size_t, 2>, 3> pairs{{{0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t s = 0; s < 3; ++s) {
    const double aj = -side[pairs[s][0]].y(), bj = side[pairs[s][0]].x();
    const double ai = -side[pairs[s][1]].y(), bi = side[pairs[s][1]].x();
    value[element.below[s]] += scale * (4.0 * ai * aj + 2.0 * bi * bj);
    value[element.below[s] + 1] += scale * 2.0 * ai * bj;
    value[element.below_y[s]] += scale * 2.0 * bi * aj;
    value[element.below_y[s] + 1] += scale * (4.0 * bi * bj + 2.0 * ai * aj);
  }
}

void KillingMatrix::add_springs(const Element& element, const std::array<Eigen::Vector2d, 3>& side,
                                double stiffness) {
  const double longest = std::max({side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm()});
  constexpr std::array<std::array<std::size_t, 2>, 3> ends{
      {{1, 2}, {0, 2}, {0, 1}}};  // of the side opposite to corner c
  constexpr std::array<std::size_t, 3> block_of_side{2, 1, 0};
  double* value = matrix_.value.data();
  for (std::size_t c = 0; c < 3; ++c) {
    value[element.diagonal[c]] += anchor * stiffness;
    value[element.diagonal_y[c]] += anchor * stiffness;
  }
  for (std::size_t s = 0; s < 3; ++s) {
    const double length = side[s].squaredNorm();
    Eigen::Matrix2d spring = stiffness * Eigen::Matrix2d::Identity();
    if (length > 1e-24 * longest) spring = (stiffness / length) * side[s] * side[s].transpose();
    for (const std::size_t c : ends[s]) {
      value[element.diagonal[c]] += spring(0, 0);
      value[element.diagonal[c] + 1] += spring(1, 0);
      value[element.diagonal_y[c]] += spring(1, 1);
    }
    const std::size_t block = block_of_side[s];
    value[element.below[block]] -= spring(0, 0);
    value[element.below[block] + 1] -= spring(1, 0);
    value[element.below_y[block]] -= spring(0, 1);
    value[element.below_y[block] + 1] -= spring(1, 1);
  }
}

}  // namespace planar
