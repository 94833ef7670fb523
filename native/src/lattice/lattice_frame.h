// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "planar/lattice.h"

namespace planar {

/// The regular grid that the points of a lattice are at rest, read from their places: point (u, v, w) is
/// origin + u step₀ + v step₁ + w step₂, and its number u + count₀ (v + count₁ w). Steps may point anywhere.
/// Layers that lie upon each other, as those of a lattice seen along its depth do, have a step of 0.
class LatticeFrame {
 public:
  /// \param points N×2 or N×3, finite, at least one
  /// \throw std::invalid_argument naming the first row that is off a grid by more than 1e-3 of a step
  explicit LatticeFrame(const Coordinates& points);

  const std::array<int, 3>& count() const { return count_; }

  /// In steps from the origin, n×3; 0 along axes that do not lead anywhere.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> in_steps(const Coordinates& places) const;

 private:
  Eigen::RowVectorXd origin_;
  Eigen::MatrixXd steps_;  ///< D×3, a column an axis
  std::array<int, 3> count_{1, 1, 1};
};

/// Σ_k coefficient_k d_{point_k}, which is 0 wherever the points make an affine motion.
struct Difference {
  std::vector<int> point;
  std::vector<double> coefficient;
};

/// Second differences along each axis, and √2 × the mixed one in each cell of each two axes.
std::vector<Difference> second_differences(const std::array<int, 3>& count);

}  // namespace planar
