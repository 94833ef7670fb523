// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lattice/lattice_springs.h"

namespace planar {

/// Where a lattice and its mesh are.
template <int D>
struct LatticePose {
  Rows<D> d;      ///< N×D: displacements of the lattice's points
  Rows<D> u;      ///< n×D: W d, of the mesh
  int wrong = 0;  ///< triangles that float32 has without area, or the other way round than at rest
};

/// What a LatticeSolver has for each of its methods.
template <int D>
class LatticeMethod {
 public:
  struct Outcome {
    int iterations = 0;
    bool converged = false;
  };

  virtual ~LatticeMethod() = default;

  /// For these handles and locked points; targets do not matter.
  /// \throw SolveError
  virtual void compile(const LatticeSprings<D>& springs) = 0;
  /// Towards new targets, from the pose or what is better.
  virtual Outcome move(const LatticeSprings<D>& springs, LatticePose<D>& pose) = 0;
  /// A bounded piece of exact work.
  virtual Outcome refine(const LatticeSprings<D>& springs, LatticePose<D>& pose) = 0;
  /// All that is left.
  virtual Outcome settle(const LatticeSprings<D>& springs, LatticePose<D>& pose) = 0;
};

}  // namespace planar
