// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "planar/types.h"

namespace planar {

/// Keeps the triangles of a posed mesh from collapsing by stiffening those that are far from their rest
/// shape. A triangle that is squeezed flat has less and less area in the Killing energy, so that nothing
/// holds it; with this it is carried along rigidly.
class TriangleGuard {
 public:
  /// \param flat m flags
  /// \param stiffness m painted factors, or empty
  TriangleGuard(const Points& rest, const Triangles& triangles, const Flags& flat,
                const Eigen::VectorXd& stiffness);

  /// Fills in m factors at x: the painted one as long as |J|² + |J⁻¹|² ≤ 8 (J: rest to x; 4 at rest, 8 when
  /// squeezed to 0.38 one way), above that multiplied by the square of the ratio. Flat triangles
  /// keep the painted factor.
  void stiffness(const Points& x, Eigen::VectorXd& result) const;

 private:
  Triangles triangles_;
  Eigen::VectorXd painted_;
  std::vector<std::array<double, 4>> inverse_;  ///< of the sides 01, 02 at rest, by rows; zeros if flat
};

}  // namespace planar
