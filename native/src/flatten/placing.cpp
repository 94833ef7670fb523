// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/placing.h"

#include <cmath>
#include <complex>

#include "base/complex_rows.h"
#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

/// Of the moments that differ in two directions, in their sum: 5 % more length than width. What is rounder,
/// as a square or a disc of triangles, has no direction that one would see.
constexpr double elongated = 0.05;

struct Moments {
  Complex centroid = 0.0;
  Complex square = 0.0;  ///< ∫ z² about the centroid
  double size = 0.0;     ///< ∫ |z|²
};

Moments moments_of(const Patch& patch, const Points& x) {
  Moments result;
  const auto for_triangles = [&](const auto& visit) {
    for (std::size_t t = 0; t < patch.corners.size(); ++t) {
      std::array<Complex, 3> z;
      for (int c = 0; c < 3; ++c) {
        z[at(c)] = complex_row(x, patch.mesh.triangles(static_cast<Eigen::Index>(t), c)) - result.centroid;
      }
      visit(patch.area_of(t) / patch.area, z);
    }
  };
  Complex centroid = 0.0;
  for_triangles([&](double share, const auto& z) { centroid += share / 3.0 * (z[0] + z[1] + z[2]); });
  result.centroid = centroid;
  for_triangles([&](double share, const auto& z) {
    const Complex sum = z[0] + z[1] + z[2];
    result.square += share / 12.0 * (z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + sum * sum);
    result.size += share / 12.0 * (std::norm(z[0]) + std::norm(z[1]) + std::norm(z[2]) + std::norm(sum));
  });
  return result;
}

Complex direction_of(const Points& x, const std::array<int, 2>& edge) {
  const Complex way = complex_row(x, edge[1]) - complex_row(x, edge[0]);
  return std::abs(way) > 0.0 ? way / std::abs(way) : 1.0;
}

Points turned_back(const Points& x, Complex centroid, Complex direction) {
  Points result(x.rows(), 2);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Complex z = std::conj(direction) * (complex_row(x, v) - centroid);
    result.row(v) << z.real(), z.imag();
  }
  return result;
}

}  // namespace

Points placed_by_edge(const Patch& patch, const Points& x, const std::array<int, 2>& along) {
  return turned_back(x, moments_of(patch, x).centroid, direction_of(x, along));
}

Points placed_by_length(const Patch& patch, const Points& x, const std::array<int, 2>& along) {
  const Moments moments = moments_of(patch, x);
  Complex direction = direction_of(x, along);
  if (std::abs(moments.square) > elongated * moments.size) {
    const Complex axis = std::polar(1.0, 0.5 * std::arg(moments.square));
    direction = (std::conj(axis) * direction).real() < 0.0 ? -axis : axis;
  }
  return turned_back(x, moments.centroid, direction);
}

}  // namespace planar
