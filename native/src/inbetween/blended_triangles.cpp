// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/blended_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/complex_product.h"
#include "inbetween/edge_turns.h"
#include "mesh/edge_graph.h"
#include "mesh/triangle_shape.h"

namespace planar {

using Complex = std::complex<double>;

namespace {

Complex side(const Points& x, int a, int b) { return {x(b, 0) - x(a, 0), x(b, 1) - x(a, 1)}; }

}  // namespace

BlendedTriangles::BlendedTriangles(const Points& from, const Points& to, const Triangles& triangles)
    : from_(from),
      to_(to),
      triangles_(triangles),
      flat_(flat_triangles(from, triangles) || flat_triangles(to, triangles)) {
  back_.reserve(static_cast<std::size_t>(triangles.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const int a = triangles(t, 0), b = triangles(t, 1), c = triangles(t, 2);
    const Complex turn = triangle_turn(side(from, a, b), side(from, a, c), side(to, a, b), side(to, a, c));
    const double size = std::abs(turn);
    back_.push_back(size > 0.0 ? std::conj(turn) / size : 1.0);
  }
}

Eigen::Vector2d BlendedTriangles::corner(int t, int v, double u) const {
  // From the first corner: far from the origin the places would leave little of the sides.
  const int a = triangles_(t, 0);
  const Complex blend =
      (1.0 - u) * side(from_, a, v) + u * product(back_[static_cast<std::size_t>(t)], side(to_, a, v));
  return {blend.real(), blend.imag()};
}

double BlendedTriangles::strain(int t, const Points& x, double u) const {
  if (flat_[t]) return 1.0;
  const int a = triangles_(t, 0), b = triangles_(t, 1), c = triangles_(t, 2);
  const Complex back = back_[static_cast<std::size_t>(t)];
  const auto wanted = [&](int end) {
    return (1.0 - u) * side(from_, a, end) + u * product(back, side(to_, a, end));
  };
  const Complex r1 = wanted(b), r2 = wanted(c), d1 = side(x, a, b), d2 = side(x, a, c);
  const double area = product(std::conj(r1), r2).imag();
  // The Jacobian is z -> αz + βz̄, its singular values are |α| ± |β|.
  const double alpha = std::abs(product(d1, std::conj(r2)) - product(d2, std::conj(r1))),
               beta = std::abs(product(r1, d2) - product(r2, d1)), size = 2.0 * std::abs(area);
  if (!(alpha > beta)) return std::numeric_limits<double>::infinity();
  return std::max((alpha + beta) / size, size / (alpha - beta));
}

}  // namespace planar
