// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lattice/lattice_springs.h"

namespace planar {

/// What a LatticeSolver has for each of its methods. d (N×D) are the displacements of the lattice's points.
template <int D>
class LatticeMethod {
 public:
  struct Outcome {
    int iterations = 0;
    bool converged = false;
    int flipped = 0;  ///< triangles that lie the other way round than at rest, as float32
  };

  virtual ~LatticeMethod() = default;

  /// For these handles and locked points; targets do not matter.
  /// \throw SolveError
  virtual void compile(const LatticeSprings<D>& springs) = 0;
  /// Towards new targets, from d or what is better.
  /// \param flipped at d
  virtual Outcome move(const LatticeSprings<D>& springs, int flipped, Rows<D>& d) = 0;
  /// A bounded piece of exact work.
  virtual Outcome refine(const LatticeSprings<D>& springs, Rows<D>& d) = 0;
  /// All that is left.
  virtual Outcome settle(const LatticeSprings<D>& springs, Rows<D>& d) = 0;
};

}  // namespace planar
