// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/checks.h"
#include "base/index.h"
#include "flatten/shortest_paths.h"
#include "mesh/triangle_shape.h"

namespace planar {

namespace {

Triangles checked(const SpacePoints& vertices, const Triangles& triangles) {
  if (vertices.rows() == 0) throw std::invalid_argument("vertices is empty");
  if (triangles.rows() == 0)
    throw std::invalid_argument("triangles is empty: a mesh needs at least one triangle");
  require_finite_rows("vertices", vertices);
  return triangles;
}

std::string edge_text(const std::array<int, 2>& edge) {
  return "the edge of vertices " + std::to_string(edge[0]) + " and " + std::to_string(edge[1]);
}

/// A side of a triangle.
struct Side {
  std::array<int, 2> edge;  ///< smaller vertex first
  int triangle;
  bool ascending;  ///< runs from the smaller vertex to the larger one
};

std::vector<Side> sorted_sides(const Triangles& triangles) {
  std::vector<Side> sides;
  sides.reserve(at(triangles.size()));
  for (int t = 0; t < static_cast<int>(triangles.rows()); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int a = triangles(t, c), b = triangles(t, (c + 1) % 3);
      sides.push_back({{std::min(a, b), std::max(a, b)}, t, a < b});
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
  return sides;
}

/// Whether each triangle is to be turned round for all to lie the same way; the way of the first is kept.
std::vector<char> turned_round(std::size_t n_triangles, const std::vector<Side>& sides) {
  struct Neighbour {
    int triangle;
    bool agrees;
    std::size_t side;
  };
  std::vector<std::vector<Neighbour>> neighbours(n_triangles);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.edge != b.edge) continue;
    const bool agrees = a.ascending != b.ascending;
    neighbours[at(a.triangle)].push_back({b.triangle, agrees, i});
    neighbours[at(b.triangle)].push_back({a.triangle, agrees, i});
  }
  std::vector<char> turned(n_triangles), reached(n_triangles);
  std::vector<int> open{0};
  reached[0] = 1;
  while (!open.empty()) {
    const int t = open.back();
    open.pop_back();
    for (const auto& [other, agrees, side] : neighbours[at(t)]) {
      const char wanted = agrees ? turned[at(t)] : !turned[at(t)];
      if (!reached[at(other)]) {
        reached[at(other)] = 1;
        turned[at(other)] = wanted;
        open.push_back(other);
      } else if (turned[at(other)] != wanted) {
        throw std::invalid_argument("triangles: the surface has one side only, as a Möbius strip has, at " +
                                    edge_text(sides[side].edge) + ": cut it there");
      }
    }
  }
  return turned;
}

Patch::Corners laid_flat(const SpacePoints& x, const int* corner) {
  const Eigen::RowVector3d u = x.row(corner[1]) - x.row(corner[0]), v = x.row(corner[2]) - x.row(corner[0]);
  const double length = u.norm();
  if (length == 0.0) return {0.0, 0.0, v.norm()};
  return {0.0, length, std::complex<double>(u.dot(v), u.cross(v).norm()) / length};
}

double corner_area(const Patch::Corners& p) { return 0.5 * p[1].real() * p[2].imag(); }

/// The closed walks along `next`, the vertex after each or -1.
std::vector<std::vector<int>> loops_of(std::vector<int> next) {
  std::vector<std::vector<int>> loops;
  for (int v = 0; v < static_cast<int>(next.size()); ++v) {
    if (next[at(v)] < 0) continue;
    std::vector<int> loop;
    for (int u = v; next[at(u)] >= 0;) {
      loop.push_back(u);
      u = std::exchange(next[at(u)], -1);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace

Patch::Patch(const SpacePoints& vertices, const Triangles& rows)
    : mesh(vertices.rows(), checked(vertices, rows)), area(0.0) {
  if (mesh.n_parts > 1) {
    throw std::invalid_argument("triangles: the surface has " + std::to_string(mesh.n_parts) +
                                " parts that hang together nowhere: flatten them one by one");
  }
  const std::vector<Side> sides = sorted_sides(mesh.triangles);
  for (std::size_t i = 2; i < sides.size(); ++i) {
    if (sides[i].edge != sides[i - 2].edge) continue;
    throw std::invalid_argument(row_of("triangles", sides[i].triangle) + "the third at " +
                                edge_text(sides[i].edge) + ": split the surface there, or leave one out");
  }
  if (!mesh.braces.empty()) {
    throw std::invalid_argument("triangles: pieces of the surface meet in vertex " +
                                std::to_string(mesh.braces[0][0]) +
                                " alone: split the vertex, or flatten them one by one");
  }
  const std::vector<char> turned = turned_round(at(mesh.triangles.rows()), sides);

  corners.resize(at(mesh.triangles.rows()));
  double kept_area = 0.0, turned_area = 0.0;
  for (std::size_t t = 0; t < corners.size(); ++t) {
    const double here = corner_area(laid_flat(vertices, mesh.triangles.data() + 3 * t));
    (turned[t] ? turned_area : kept_area) += here;
  }
  area = kept_area + turned_area;
  if (!std::isfinite(area)) throw std::invalid_argument("vertices: numbers this large have no area");
  const bool turn_others = turned_area > kept_area;
  for (std::size_t t = 0; t < corners.size(); ++t) {
    int* corner = mesh.triangles.data() + 3 * t;
    if ((turned[t] != 0) != turn_others) std::swap(corner[1], corner[2]);
    corners[t] = laid_flat(vertices, corner);
  }
  flat = flat_triangles(vertices, mesh.triangles);
  if (flat.all()) {
    throw std::invalid_argument("vertices: the surface has no area: dissolve what is degenerate in it");
  }

  std::vector<int> next(at(mesh.n_vertices), -1);
  // For each edge (a, b), a < b: whether a triangle is on its left and on its right.
  std::vector<std::array<bool, 2>> beside(mesh.edges.size());
  std::size_t e = 0;
  for (const Side& side : sides) {
    while (mesh.edges[e] != side.edge) ++e;
    const auto [a, b] = side.edge;
    const int* corner = mesh.triangles.data() + 3 * static_cast<std::ptrdiff_t>(side.triangle);
    const bool left = (corner[0] == a && corner[1] == b) || (corner[1] == a && corner[2] == b) ||
                      (corner[2] == a && corner[0] == b);
    beside[e][left ? 0 : 1] = true;
  }
  for (e = 0; e < beside.size(); ++e) {
    const auto [a, b] = mesh.edges[e];
    length.push_back((vertices.row(a) - vertices.row(b)).norm());
    if (!beside[e][0]) next[at(b)] = a;
    if (!beside[e][1]) next[at(a)] = b;
  }
  loops = loops_of(std::move(next));
  if (loops.empty()) {
    throw std::invalid_argument("triangles: the surface is closed: cut it open along a seam");
  }
  const auto n_used = mesh.n_vertices - std::count(mesh.part.begin(), mesh.part.end(), -1);
  const auto euler = n_used - static_cast<std::ptrdiff_t>(mesh.edges.size()) + mesh.triangles.rows();
  const auto handles = (2 - euler - static_cast<std::ptrdiff_t>(loops.size())) / 2;
  if (handles > 0) {
    throw std::invalid_argument("triangles: the surface has " + std::to_string(handles) +
                                (handles == 1 ? " handle" : " handles") +
                                ", as that of a cup: cut each open along a seam");
  }
  const auto longest = std::max_element(
      loops.begin(), loops.end(),
      [this](const auto& one, const auto& other) { return length_of(one) < length_of(other); });
  std::iter_swap(loops.begin(), longest);
}

double Patch::length_of(const std::vector<int>& loop) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    sum += length[at(mesh.find_edge(loop[i], loop[(i + 1) % loop.size()]))];
  }
  return sum;
}

RestOf Patch::rest_of() const {
  return [this](int t, int v) -> Eigen::Vector2d {
    const auto row = mesh.triangles.row(t);
    const std::complex<double> p = corners[at(t)][row[0] == v ? 0 : row[1] == v ? 1 : 2];
    return {p.real(), p.imag()};
  };
}

std::array<int, 2> Patch::central_edge() const {
  // The distances from three vertices, each far from the one before, stand for those from all.
  std::vector<double> farthest(at(mesh.n_vertices), 0.0);
  int from = mesh.edges[0][0];
  for (int round = 0; round < 4; ++round) {
    const std::vector<double> distance = ShortestPaths({from}, farthest.size(), mesh.edges, length).distance;
    for (int v = 0; v < mesh.n_vertices; ++v) {
      if (mesh.part[at(v)] < 0) continue;
      if (round > 0) farthest[at(v)] = std::max(farthest[at(v)], distance[at(v)]);
      if (distance[at(v)] > distance[at(from)]) from = v;
    }
  }
  std::array<int, 2> central{-1, -1};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const double sum = farthest[at(mesh.edges[e][0])] + farthest[at(mesh.edges[e][1])];
    if (length[e] > 0.0 && sum < least) {
      least = sum;
      central = mesh.edges[e];
    }
  }
  return central;
}

}  // namespace planar
