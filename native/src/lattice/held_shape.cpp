// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/held_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.h"
#include "mesh/triangle_shape.h"

namespace planar {

namespace {

constexpr double latest = 4.0;  // t of a collapse that is of interest

}  // namespace

double Jacobian::value() const {
  const double d = delta(), s = square();
  return d > 0.0 ? s + s / (d * d) - 4.0 : std::numeric_limits<double>::infinity();
}

std::array<double, 4> Jacobian::slope() const {
  const double inverse = 1.0 / delta(), square_of = inverse * inverse;
  const double along = 2.0 * (1.0 + square_of), across = -2.0 * square() * square_of * inverse;
  const auto& [a, b, c, e] = entry;
  return {along * a + across * e, along * b - across * c, along * c - across * b, along * e + across * a};
}

std::array<std::array<double, 4>, 4> Jacobian::form() const {
  const auto& [a, b, c, e] = entry;
  const std::array<double, 4> q{e, -c, -b, a};  // of δ
  const double d = delta(), s = square();
  const double inverse = 1.0 / d, i2 = inverse * inverse, i3 = i2 * inverse;
  const double same = 2.0 * (1.0 + i2), mixed = -4.0 * i3, across = 6.0 * s * i2 * i2, cross = -2.0 * s * i3;
  const double twisted = 2.0 - 2.0 * (s - d) * i3;
  const double rc = a + e, rs = c - b;
  const double lift = twisted < 0.0 ? -0.5 * twisted / (rc * rc + rs * rs) : 0.0;
  const std::array<double, 4> t{-rs, -rc, rc, -rs};
  std::array<std::array<double, 4>, 4> result{};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t l = 0; l < 4; ++l) {
      result[k][l] = mixed * (entry[k] * q[l] + q[k] * entry[l]) + across * q[k] * q[l] + lift * t[k] * t[l];
    }
    result[k][k] += same;
    result[k][3 - k] += k == 0 || k == 3 ? cross : -cross;
  }
  return result;
}

HeldShape::HeldShape(const Points& rest, const Triangles& triangles, const Flags& flat) : rest_(rest) {
  triangles_.reserve(at(triangles.rows()));
  corners_.reserve(at(triangles.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (flat[t]) continue;
    const std::array<int, 3> v{triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    const double doubled = doubled_area(rest, v.data());
    const Eigen::RowVector2d side1 = rest.row(v[0]) - rest.row(v[2]), side2 = rest.row(v[1]) - rest.row(v[0]);
    // The gradient of a corner's hat function is its opposite side, turned by 90°, over twice the area.
    triangles_.push_back({v, -side1.y() / doubled, side1.x() / doubled, -side2.y() / doubled,
                          side2.x() / doubled, 0.5 * std::abs(doubled)});
    area_ += triangles_.back().area;
    corners_.push_back(doubled > 0.0 ? v : std::array{v[0], v[2], v[1]});
  }
}

double HeldShape::value(const Points& u) const {
  double sum = 0.0;
  for (const Triangle& triangle : triangles_) sum += triangle.area * triangle.jacobian(u).value();
  return sum;
}

double HeldShape::gradient(const Points& u, Points& result) const {
  result.setZero(u.rows(), 2);
  double sum = 0.0;
  for (const Triangle& triangle : triangles_) {
    const Jacobian j = triangle.jacobian(u);
    sum += triangle.area * j.value();
    const std::array<double, 4> slope = j.slope();
    for (int c = 0; c < 3; ++c) {
      const auto [gx, gy] = triangle.gradient(c);
      double* r = result.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[at(c)]);
      r[0] += triangle.area * (slope[0] * gx + slope[1] * gy);
      r[1] += triangle.area * (slope[2] * gx + slope[3] * gy);
    }
  }
  return sum;
}

namespace {

/// Two sides of a triangle, from its first corner.
struct Sides {
  double ax, ay, bx, by;

  Sides(const Points& x, const std::array<int, 3>& corner) {
    const double* p0 = x.data() + 2 * static_cast<std::ptrdiff_t>(corner[0]);
    const double* p1 = x.data() + 2 * static_cast<std::ptrdiff_t>(corner[1]);
    const double* p2 = x.data() + 2 * static_cast<std::ptrdiff_t>(corner[2]);
    ax = p1[0] - p0[0];
    ay = p1[1] - p0[1];
    bx = p2[0] - p0[0];
    by = p2[1] - p0[1];
  }

  void add(const Sides& other) {
    ax += other.ax;
    ay += other.ay;
    bx += other.bx;
    by += other.by;
  }
  double doubled_area() const { return ax * by - ay * bx; }
};

}  // namespace

bool HeldShape::is_upright(const Points& u) const {
  return std::all_of(corners_.begin(), corners_.end(), [&](const std::array<int, 3>& corner) {
    Sides sides(rest_, corner);
    sides.add({u, corner});
    return sides.doubled_area() > 0.0;
  });
}

HeldShape::Collapse HeldShape::first_collapse(const Points& u, const Points& du) const {
  Collapse first{std::numeric_limits<double>::infinity(), -1};
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    Sides side(rest_, corners_[t]);
    side.add({u, corners_[t]});
    const Sides way(du, corners_[t]);
    // Twice the area is c0 + c1 t + c2 t².
    const double c0 = side.doubled_area(), c2 = way.doubled_area();
    if (!(c0 > 0.0)) continue;
    const double c1 = (side.ax * way.by - side.ay * way.bx) + (way.ax * side.by - way.ay * side.bx);
    const double soon = std::min(first.t, latest);
    if (c0 + soon * (std::min(c1, 0.0) + soon * std::min(c2, 0.0)) > 0.0) continue;
    const double discriminant = c1 * c1 - 4.0 * c0 * c2;
    if (discriminant < 0.0) continue;
    // The least positive root, in the form that does not cancel and holds for c2 = 0 as well.
    const double q = std::sqrt(discriminant) - c1;
    if (q > 0.0 && 2.0 * c0 < first.t * q) first = {2.0 * c0 / q, static_cast<int>(t)};
  }
  return first;
}

}  // namespace planar
