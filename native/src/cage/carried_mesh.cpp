// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/carried_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh/triangle_shape.h"

namespace planar {
namespace {

constexpr int flip_sweeps = 3;
constexpr double kept_quality = 0.9;  // of the worst triangle, where a vertex is smoothed

}  // namespace

double CarriedMesh::quality(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b,
                            const Eigen::RowVector2d& c) {
  const Eigen::RowVector2d ab = b - a, ac = c - a, bc = c - b;
  const double sum = ab.squaredNorm() + ac.squaredNorm() + bc.squaredNorm();
  return sum > 0.0 ? 2.0 * std::sqrt(3.0) * (ab.x() * ac.y() - ab.y() * ac.x()) / sum : 0.0;
}

CarriedMesh::CarriedMesh(const Points& dense, Points points, const Triangles& triangles,
                         const std::vector<int>& triangle_of)
    : dense_(dense),
      points_(std::move(points)),
      mesh_(points_, triangles),
      head_(at(triangles.rows()), -1),
      link_(triangle_of.size(), -1) {
  for (std::size_t v = 0; v < triangle_of.size(); ++v) {
    if (triangle_of[v] < 0) continue;
    link_[v] = head_[at(triangle_of[v])];
    head_[at(triangle_of[v])] = static_cast<int>(v);
  }
}

double CarriedMesh::quality_of(int triangle) const {
  const int* corner = mesh_.corners(triangle);
  return quality(at_vertex(corner[0]), at_vertex(corner[1]), at_vertex(corner[2]));
}

double CarriedMesh::area_of(int triangle) const {
  return 0.5 * doubled_area(points_, mesh_.corners(triangle));
}

int CarriedMesh::count_in(int triangle) const {
  int count = 0;
  for (int v = head_[at(triangle)]; v >= 0; v = link_[at(v)]) ++count;
  return count;
}

void CarriedMesh::collapse(const HalfEdges::Side& side) {
  star_.clear();
  mesh_.for_fan(side.u, [this](int h) { star_.push_back(h / 3); });
  take(star_);
  mesh_.collapse(side);
  std::erase_if(star_, [this](int t) { return !mesh_.is_alive(t); });
  put(star_);
}

int CarriedMesh::split(int h) {
  const Eigen::RowVector2d middle = 0.5 * (at_vertex(mesh_.origin(h)) + at_vertex(mesh_.target(h)));
  star_ = {h / 3};
  if (mesh_.twin(h) >= 0) star_.push_back(mesh_.twin(h) / 3);
  take(star_);
  const int before = mesh_.n_triangles(), m = mesh_.split(h);
  for (int t = before; t < mesh_.n_triangles(); ++t) star_.push_back(t);
  head_.resize(at(mesh_.n_triangles()), -1);
  points_.conservativeResize(m + 1, 2);
  points_.row(m) = middle;
  put(star_);
  return m;
}

void CarriedMesh::flip_to_delaunay(bool rows) {
  for (int sweep = 0; sweep < flip_sweeps; ++sweep) {
    bool any = false;
    for (int h = 0; h < 3 * mesh_.n_triangles(); ++h) {
      if (mesh_.twin(h) <= h || !wants_flip(h, rows) || !mesh_.can_flip(h)) continue;
      star_ = {h / 3, mesh_.twin(h) / 3};
      take(star_);
      mesh_.flip(h);
      put(star_);
      any = true;
    }
    if (!any) break;
  }
}

bool CarriedMesh::wants_flip(int h, bool rows) const {
  const int g = mesh_.twin(h);
  const int a = mesh_.origin(h), b = mesh_.target(h);
  const int c = mesh_.origin(HalfEdges::previous(h)), d = mesh_.origin(HalfEdges::previous(g));
  const auto cross = [this](int p, int q, int r) {
    const Eigen::RowVector2d u = at_vertex(q) - at_vertex(p), v = at_vertex(r) - at_vertex(p);
    return u.x() * v.y() - u.y() * v.x();
  };
  const auto dot = [this](int p, int q, int r) {
    return (at_vertex(q) - at_vertex(p)).dot(at_vertex(r) - at_vertex(p));
  };
  // The cotangents of the angles at c and d have a sum below 0 where these are more than 180 degrees.
  if (!(dot(c, a, b) * cross(d, b, a) + dot(d, b, a) * cross(c, a, b) < 0.0)) return false;
  if (!(cross(a, d, c) > 0.0 && cross(d, b, c) > 0.0)) return false;
  if (rows && mesh_.is_boundary(c) && mesh_.is_boundary(d))
    return mesh_.is_boundary(a) && mesh_.is_boundary(b);
  return true;
}

void CarriedMesh::smooth(int v, const std::vector<double>& sizes) {
  Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
  double weights = 0.0, worst = 1.0;
  star_.clear();
  mesh_.for_fan(v, [&](int h) {
    const int* corner = mesh_.corners(h / 3);
    star_.push_back(h / 3);
    worst = std::min(worst, quality_of(h / 3));
    const double size = sizes[at(corner[0])] + sizes[at(corner[1])] + sizes[at(corner[2])];
    const double weight = doubled_area(points_, corner) / (size * size);
    sum += weight * (at_vertex(corner[0]) + at_vertex(corner[1]) + at_vertex(corner[2])) / 3.0;
    weights += weight;
  });
  if (!(weights > 0.0)) return;
  const Eigen::RowVector2d before = at_vertex(v);
  points_.row(v) = sum / weights;
  double now = 1.0;
  for (const int t : star_) now = std::min(now, quality_of(t));
  if (!(now > 0.0 && now >= kept_quality * worst)) {
    points_.row(v) = before;
    return;
  }
  take(star_);
  put(star_);
}

void CarriedMesh::take(const std::vector<int>& triangles) {
  taken_.clear();
  for (const int t : triangles) {
    for (int v = head_[at(t)]; v >= 0; v = link_[at(v)]) taken_.push_back(v);
    head_[at(t)] = -1;
  }
}

/// Puts each of what was taken into that of the triangles which it lies in, or nearest to.
void CarriedMesh::put(const std::vector<int>& triangles) {
  for (const int v : taken_) {
    const double x = dense_(v, 0), y = dense_(v, 1);
    int found = triangles.front();
    double nearest = std::numeric_limits<double>::infinity();
    for (const int t : triangles) {
      const int* corner = mesh_.corners(t);
      double outside = 0.0;  // squared distance from the furthest side that it lies beyond
      for (int c = 0; c < 3; ++c) {
        const double* a = points_.data() + 2 * corner[c];
        const double* b = points_.data() + 2 * corner[(c + 1) % 3];
        const double dx = b[0] - a[0], dy = b[1] - a[1];
        const double side = dx * (y - a[1]) - dy * (x - a[0]);
        if (side < 0.0) outside = std::max(outside, side * side / (dx * dx + dy * dy));
      }
      if (outside < nearest) {
        nearest = outside;
        found = t;
      }
      if (outside == 0.0) break;
    }
    link_[at(v)] = head_[at(found)];
    head_[at(found)] = v;
  }
}

Triangles CarriedMesh::triangles(const std::vector<int>& number) const {
  std::vector<int> corners;
  for (int t = 0; t < mesh_.n_triangles(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    for (int c = 0; c < 3; ++c) corners.push_back(number[at(mesh_.corners(t)[c])]);
  }
  return Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
}

std::vector<int> CarriedMesh::owners() const {
  std::vector<int> result(link_.size(), -1);
  int n = 0;
  for (int t = 0; t < mesh_.n_triangles(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    for (int v = head_[at(t)]; v >= 0; v = link_[at(v)]) result[at(v)] = n;
    ++n;
  }
  return result;
}

}  // namespace planar
