// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "energy/mesh_matrix.h"

namespace planar {

/// The matrix K = PᵀP of the Killing energy ∫|J + Jᵀ|² [AKVF 2, 5-7] over some
/// vertices of a mesh. Per triangle, with Gx, Gy the gradients of the hat functions, P = √A·[2Gx 0; √2·Gy
/// √2·Gx; 0 2Gy]; printed without the integral's area and with the full G in every entry, it would give
/// rotations energy. K does not depend on the unit of length.
///
/// The area that P divides by is at least 1e-5 of the longest edge squared, and a triangle below that gets
/// springs along its edges (of the stiffness of that least area), because a flat one does not resist
/// stretching: so every triangle's energy is zero for rigid motions only, however flat it is. Flat triangles
/// next to each other may still be hinged at an edge without length; a hundredth of the springs' stiffness
/// holds their corners where they are, or rather where the rigid field that the solver takes off first puts
/// them. Orientation does not matter.
class KillingMatrix : public MeshMatrix {
 public:
  using MeshMatrix::MeshMatrix;

  /// Fills in K for positions x, with stiffness[t] times the energy of triangle t. Parts that are not
  /// `active` get unit rows.
  void assemble(const Points& x, const Eigen::VectorXd& stiffness, const std::vector<char>& active);

 private:
  void add_element(const Element& element, const Points& x, double stiffness);
  void add_springs(const Element& element, const std::array<Eigen::Vector2d, 3>& side, double stiffness);
};

}  // namespace planar
