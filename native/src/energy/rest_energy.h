// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "energy/mesh_matrix.h"
#include "planar/types.h"

namespace planar {

/// How far a mesh is from its rest shape: the symmetric Dirichlet energy
///
///   E(x) = Σ k_t A_t (|J|² + |J⁻¹|² - 4),   J: rest -> x,
///
/// with A_t the areas at rest; 0 for rigid motions, infinite where a triangle collapses. [Smith15] Only the
/// orientation relative to rest counts.
///
/// In complex numbers J is z -> a z + b z̄, |J|² = s = 2(|a|² + |b|²), det J = δ = |a|² - |b|², and a
/// triangle's energy is s ψ(δ) with ψ = 1 + δ⁻². Its Hessian in J is diagonal in the directions along and
/// across a and b, but for a coupling of the two along: the eigensystem of [Smith19], without a singular
/// value decomposition. Of its eigenvalues only that of the twist, across a, can be negative.
///
/// Triangles that are flat at rest (mesh/triangle_shape.h) get springs that follow them, k c Σ_edges |e - R
/// e_rest|² with R the best rotation, which hold their corners in place and can be turned over without harm.
/// They are as stiff as good triangles, or else needles would open like cracks; a hundred times stiffer, they
/// would turn as slowly as stiff triangles do.
///
/// Triangles that are inverted to begin with (relax()) have the χ of [Garanzha21] in place of δ: finite
/// energy, and a force that turns them back.
class RestEnergy {
 public:
  /// Of no triangles: 0.
  RestEnergy() = default;

  /// \param matrix what add_hessian() will add to; its elements give the triangles
  /// \param flat m flags
  /// \param stiffness m factors, or empty: all 1
  RestEnergy(const Points& rest, const MeshMatrix& matrix, const Flags& flat,
             const Eigen::VectorXd& stiffness);

  /// The same for triangles that need not fit together at rest.
  RestEnergy(const RestOf& rest_of, const MeshMatrix& matrix, const Flags& flat,
             const Eigen::VectorXd& stiffness);

  /// Chooses the triangles to be repaired, those with det J below 1e-3 at x. To be called before the others
  /// when x was not reached from a shape without inverted triangles.
  void relax(const Points& x);
  /// Ends the repair of triangles that have come right, and sets χ to a tenth for the others at x. This
  /// changes the energy.
  void tighten(const Points& x);

  double value(const Points& x) const;
  /// Value, and n×2 derivatives by the vertices.
  double gradient(const Points& x, Points& result) const;
  enum class Hessian {
    projected,  ///< negative eigenvalues of each triangle are set to 0, so that it is semidefinite
    full,       ///< but for triangles that are under repair or flat, which are projected
  };
  /// Adds the Hessian at x of the parts that are `active`.
  void add_hessian(const Points& x, const std::vector<char>& active, MeshMatrix& matrix,
                   Hessian kind = Hessian::projected) const;
  /// The least t > 0 at which x + t·direction has a triangle without area that has some at x; infinite if
  /// there is none. Triangles that are inverted at x do not count.
  double first_collapse(const Points& x, const Points& direction) const;

 private:
  struct Triangle {
    std::size_t element;        ///< of the matrix
    std::array<int, 3> vertex;  ///< in the order of the element
    double g1x, g1y, g2x, g2y;  ///< half the gradients at rest of the hat functions of corners 1 and 2
    double inverse;             ///< of twice the signed area at rest
    double weight;              ///< k_t A_t
    double softening;           ///< ε² of χ, 0 if not under repair
  };
  struct FlatTriangle {
    std::size_t element;
    std::array<int, 3> vertex;
    std::array<Eigen::Vector2d, 3> side;  ///< at rest, opposite to the corner
    double weight;
  };
  struct Jacobian;

  static Jacobian jacobian(const Triangle& triangle, const Points& x);
  double add_flat_gradient(const FlatTriangle& flat, const Points& x, Points* result) const;

  std::vector<Triangle> triangles_;
  std::vector<FlatTriangle> flat_;
};

}  // namespace planar
