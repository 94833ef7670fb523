// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lattice/held_shape.h"
#include "lattice/weight_rows.h"

namespace planar {

/// Some triangles that stand for all of them, each with an area of its own and with its rows G W, by which J
/// = I + Σ_p d_p g_pᵀ follows from the points of the lattice directly.
class HeldSamples {
 public:
  explicit HeldSamples(const LatticeWeights& weights) : sum_(weights) {}

  /// \param number of the triangle, by which it is known
  void add(const HeldShape::Triangle& triangle, int number, double area);
  /// Forgets all but the first.
  void shorten(std::size_t size);
  std::size_t size() const { return area_.size(); }

  int triangle(std::size_t i) const { return triangle_[i]; }
  double area(std::size_t i) const { return area_[i]; }

  Jacobian jacobian(std::size_t i, const Points& d) const;
  /// Σ area (|J|² + |J⁻¹|² - 4); its derivatives are added to `gradient` (N×2) if there is one.
  double value(const Points& d, Points* gradient) const;

 private:
  RowSum sum_;
  std::vector<std::ptrdiff_t> start_{0};
  std::vector<int> point_, triangle_;
  std::vector<std::array<double, 2>> gradient_;
  std::vector<double> area_;
};

}  // namespace planar
