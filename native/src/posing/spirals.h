// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "mesh/mesh.h"

namespace planar {

/// Advances the vertices of one mesh along logarithmic spirals, see planar/log_spiral.h. Two stages, so that
/// the step can be chosen by what it does to the edges, and made smaller without computing it anew.
class Spirals {
 public:
  explicit Spirals(const Mesh& mesh);

  /// Takes positions and velocities (n×2) and returns the largest |z| of an edge: by how much it turns and
  /// stretches in unit time.
  double prepare(const Points& x, const Points& velocities);

  /// The prepared positions after time t.
  void advance(double t, Points& result);

  /// Gives three vertices the mean of their factors φ and updates their rows of the result of the last
  /// advance(). With one factor for all corners a triangle undergoes an affine map near to its field's,
  /// however thin it is; with three, differences in φ times the velocity (not relative to the triangle) can
  /// turn a thin one over.
  void share(const int* corner, Points& result);

 private:
  void place(std::size_t i, Points& result) const;

  std::vector<std::array<int, 2>> edges_;
  std::vector<double> inverse_degree_;  ///< 0 without edges
  std::vector<std::complex<double>> x_, velocity_, phi_;
  std::vector<double> z_real_, z_imag_;  ///< apart, so that the compiler computes several edges at once
  double largest_ = 0.0;
  double t_ = 0.0;
};

}  // namespace planar
