// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lattice/point_matrix.h"
#include "lattice/ring_energy.h"

namespace planar {

/// The alternation of [LPFFD 9] over some rings: rotations, then the points that are best for them.
template <int D>
class PaperSystem {
 public:
  /// \param lattice_rest must outlive this
  /// \param coupled pairs of points: those of all edges
  PaperSystem(RingEnergy<D> rings, const Rows<D>& lattice_rest,
              const std::vector<std::array<int, 2>>& coupled, double shape_weight, double rest_weight,
              bool rigid_following);

  /// Factors for these handles; the pattern and what the rings add to it stay.
  /// \throw SolveError
  void compile(const LatticeSprings<D>& springs);

  /// The energy at d with the best rotations, and the d that is best for them.
  /// \param next filled in if there is one
  double step(const LatticeSprings<D>& springs, const Rows<D>& d, Rows<D>* next);

 private:
  RingEnergy<D> rings_;
  const Rows<D>& lattice_rest_;
  double shape_weight_, rest_weight_;
  bool rigid_following_;
  PointMatrix matrix_;
  std::vector<double> shape_values_;  ///< of the matrix, without handles
  Rows<D> force_;
  RightSides side_;
};

}  // namespace planar
