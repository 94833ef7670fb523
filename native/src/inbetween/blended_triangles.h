// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "planar/types.h"

namespace planar {

/// The triangles of a mesh between two keys, each on its own, as they would like to be: the second key's,
/// turned back by the rotation of the polar decomposition, is blended with the first one's. With J = R S the
/// Jacobian between them that is the first one stretched by (1-u) I + u S. Seen from the second key it is the
/// same but for a rotation.
///
/// A triangle that is flat in one of the keys is flat.
class BlendedTriangles {
 public:
  BlendedTriangles(const Points& from, const Points& to, const Triangles& triangles);

  const Flags& flat() const { return flat_; }

  /// Corner v of triangle t at u, seen from its first one.
  Eigen::Vector2d corner(int t, int v, double u) const;

  /// The least number such that triangle t at x is nowhere more than that times as long or as short as it
  /// would like to be; infinite if it is flipped or without area, 1 if it is flat.
  double strain(int t, const Points& x, double u) const;

 private:
  using Complex = std::complex<double>;

  Points from_, to_;
  Triangles triangles_;
  Flags flat_;
  std::vector<Complex> back_;  ///< the rotation of a triangle of the second key
};

}  // namespace planar
