// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/cage_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cage/carried_mesh.h"
#include "mesh/triangle_shape.h"

namespace planar {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

constexpr double rows_across = 1.1;  // of the distance to the boundary on the medial axis: gives two rows
constexpr double grading = 0.35;
/// Two neighbours are on both sides of the axis where what is nearest to them on the boundary is so many
/// times as far apart as it is from them, and as they are from each other.
constexpr double across_axis = 1.5, across_edge = 2.5;
constexpr double shortest = 1.0 / 6.0;  // of the longest
constexpr double sharp = 3.7;           // radians of a re-entrant corner: there stresses have a peak
constexpr int halvings = 30;

/// Passes values on from vertex to vertex until none falls: meet(from, to) says whether it lowered that of
/// `to`.
void spread(const HalfEdges& mesh, std::vector<int> open, const auto& meet) {
  std::vector<int> next;
  std::vector<char> waiting(at(mesh.n_vertices()));
  while (!open.empty()) {
    next.clear();
    for (const int v : open) waiting[at(v)] = 0;
    for (const int v : open) {
      if (mesh.is_fixed(v)) continue;
      mesh.for_sides(v, [&](const HalfEdges::Side& side) {
        if (!meet(v, side.v) || waiting[at(side.v)]) return;
        waiting[at(side.v)] = 1;
        next.push_back(side.v);
      });
    }
    std::swap(open, next);
  }
}

/// Of the triangles round a vertex.
double angle_at(const Points& points, const HalfEdges& mesh, int v) {
  double sum = 0.0;
  mesh.for_fan(v, [&](int h) {
    const Eigen::RowVector2d a = points.row(mesh.target(h)) - points.row(v);
    const Eigen::RowVector2d b = points.row(mesh.origin(HalfEdges::previous(h))) - points.row(v);
    sum += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  });
  return sum;
}

}  // namespace

std::vector<double> cage_sizes(const Points& points, const HalfEdges& mesh, int wished) {
  const auto n = at(mesh.n_vertices());
  const auto apart = [&points](int a, int b) { return (points.row(a) - points.row(b)).norm(); };

  std::vector<double> room(n);  // that each vertex has
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const double area = doubled_area(points, mesh.corners(t));
    for (int c = 0; c < 3; ++c) room[at(mesh.corners(t)[c])] += area / 6.0;
  }
  double area = 0.0;
  for (const double share : room) area += share;
  const double even = std::sqrt(area / (vertex_cell * wished));

  // The nearest vertex of the boundary, as far as an axis could ask for shorter edges than these.
  const double furthest = 2.0 * even / rows_across;
  std::vector<int> nearest(n, -1), rim;
  std::vector<double> distance(n, unlimited);
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.out(v) < 0 || !mesh.is_boundary(v)) continue;
    nearest[at(v)] = v;
    distance[at(v)] = 0.0;
    rim.push_back(v);
  }
  spread(mesh, std::move(rim), [&](int from, int to) {
    const double d = apart(nearest[at(from)], to);
    if (!(d < distance[at(to)]) || d > furthest) return false;
    distance[at(to)] = d;
    nearest[at(to)] = nearest[at(from)];
    return true;
  });

  std::vector<double> size(n, unlimited);
  std::vector<int> axis;
  for (int h = 0; h < 3 * mesh.n_triangles(); ++h) {
    const int a = mesh.origin(h), b = mesh.target(h);
    if (a > b || mesh.twin(h) < 0 || nearest[at(a)] < 0 || nearest[at(b)] < 0) continue;
    const double d = std::max(distance[at(a)], distance[at(b)]);
    const double gap = apart(nearest[at(a)], nearest[at(b)]);
    if (d == 0.0 || gap <= across_axis * d || gap <= across_edge * apart(a, b)) continue;
    for (const int v : {a, b}) {
      if (size[at(v)] == unlimited) axis.push_back(v);
      size[at(v)] = std::min(size[at(v)], rows_across * d);
    }
  }
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.out(v) < 0 || mesh.is_fixed(v) || !mesh.is_boundary(v) || angle_at(points, mesh, v) < sharp)
      continue;
    size[at(v)] = shortest * even;
    axis.push_back(v);
  }
  spread(mesh, std::move(axis), [&](int from, int to) {
    const double s = size[at(from)] + grading * apart(from, to);
    if (!(s < size[at(to)]) || s > 4.0 * even) return false;
    size[at(to)] = s;
    return true;
  });

  const auto limited = [&size](std::size_t v, double longest) {
    return std::clamp(size[v], shortest * longest, longest);
  };
  const auto count = [&](double longest) {
    double sum = 0.0;
    for (std::size_t v = 0; v < n; ++v) {
      const double s = limited(v, longest);
      sum += std::min(1.0, room[v] / (vertex_cell * s * s));
    }
    return sum;
  };
  double low = 0.25 * even, high = 4.0 * even;
  for (int i = 0; i < halvings && high > 1.01 * low; ++i) {
    const double middle = std::sqrt(low * high);
    (count(middle) > wished ? low : high) = middle;
  }
  for (std::size_t v = 0; v < n; ++v) size[v] = limited(v, high);
  return size;
}

}  // namespace planar
