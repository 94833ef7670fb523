// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "energy/rigid_fit.h"

namespace planar {

/// A spring from a point of a part to a place, or to a point of another part.
struct Tie {
  int part, other;  ///< other: -1 for a place
  double weight;
  std::complex<double> from, to;
};

/// The points of a part, and where they return to where ties do not say: Σ |at(p) - q|² counts weight times.
struct Return {
  double weight = 0.0;
  double count = 0.0;             ///< of points
  std::complex<double> from, to;  ///< the means of p and q
  double spread = 0.0;            ///< Σ |p - from|²
  std::complex<double> turn;      ///< Σ conj(p - from) (q - to)
};

/// The rigid motions, one a part, which together have the least sum of all springs, found from none by
/// Newton steps, which end after some. Where ties leave motions free, as hinges do, the return decides.
/// Nothing moves if the sum does not fall.
///
/// \param parts one a part; those without points (count 0) do not move
/// \param size of the shape: steps are small or large beside it
std::vector<RigidMotion> fit_hinged_motions(const std::vector<Return>& parts, const std::vector<Tie>& ties,
                                            double size);

}  // namespace planar
