// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cage/cage.h"
#include "energy/rest_energy.h"
#include "mesh/mesh.h"

namespace planar {

/// Has a cage balance where the dense mesh does: forces on its vertices that make up for what its rest energy
/// does otherwise than the mesh's, at the positions that it is made for,
///
///   load = ∇E_cage(fitted) - Pᵀ ∇E_mesh(x),   P: cage -> mesh,
///
/// the full approximation scheme of multigrid methods [Brandt77]. With the pins' springs it pulls at the cage
/// there as they and the mesh's energy do at the mesh: where the mesh is at its minimum the cage is at its
/// own. Departure: the forces turn with the cage, or they would hold it back where it is turned.
class CageCorrection {
 public:
  /// None.
  CageCorrection() = default;

  /// \param mesh of the cage
  /// \param energy of the cage, and of the dense mesh
  /// \param fitted c×2, x n×2; without triangles that are turned over
  CageCorrection(const Cage& cage, const Mesh& mesh, const RestEnergy& energy, const RestEnergy& dense_energy,
                 const Points& fitted, const Points& x);

  bool is_empty() const { return loads_.rows() == 0; }

  /// How much of it holds for each part of the cage at x: all where it is made for, nothing where a vertex is
  /// far from there.
  std::vector<double> shares_at(const Mesh& mesh, const Points& x, double size) const;

  /// c×2
  Points loads_at(const Mesh& mesh, const Points& x, const std::vector<double>& shares) const;

 private:
  Points fitted_{0, 2};
  Points loads_{0, 2};
};

}  // namespace planar
