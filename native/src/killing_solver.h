// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "killing_energy.h"
#include "mesh.h"
#include "pin.h"
#include "planar/handle.h"
#include "sparse_solver.h"
#include "worker.h"

namespace planar {

/// The solver behind killing_field and the Poser: as-Killing-as-possible fields of one mesh at any positions
/// of its vertices. The topology is analysed once; handles only change numbers.
class KillingSolver {
 public:
  struct Options {
    bool hard = false;
    bool dirichlet = true;
    Backend backend = default_backend();
  };

  KillingSolver(Mesh mesh, Options options);

  /// Prepares handles; they come into force with use(), which cannot fail.
  ///
  /// \param weights k: λ² of each handle
  ///
  /// \param patch k flags, or empty: handles that (8) is not to smooth away. Smoothing is for handles that
  /// pull at a single point of the interior; a patch spreads its pull, and (8) would lose the turn of a patch
  /// that lies inside.
  ///
  /// \throw std::invalid_argument a handle is not inside a triangle, edge or vertex of the mesh
  std::vector<Pin> compile(const Handles& handles, const Eigen::VectorXd& weights,
                           const std::vector<char>& patch = {});
  void use(std::vector<Pin> pins) noexcept { pins_ = std::move(pins); }

  /// The field (n×2) of the mesh at x (n×2) with `stiffness` (m, or empty: all 1) for handle velocities
  /// (k×2), all finite. See killing_field.
  ///
  /// \throw SolveError
  void solve(const Points& x, const Eigen::VectorXd& stiffness, const Points& velocities, Points& field);

  const Mesh& mesh() const { return mesh_; }

 private:
  /// The rigid field mean + rate·R90·(p - centre) nearest to a part's pin velocities.
  struct RigidField {
    Eigen::RowVector2d centre, mean;
    double rate;
    Eigen::RowVector2d at(const Eigen::RowVector2d& p) const {
      return {mean.x() - rate * (p.y() - centre.y()), mean.y() + rate * (p.x() - centre.x())};
    }
  };

  /// A Killing matrix over some vertices, in an order that keeps its factor sparse.
  struct System {
    System(const Mesh& mesh, std::vector<int> kept, Backend backend);
    std::unique_ptr<SparseSolver> solver;
    KillingMatrix killing;
    Eigen::VectorXd unknown;
  };

  void fit_rigid_fields(const Points& x, const Points& velocities);
  bool is_smoothed(const Pin& pin) const;
  void solve_soft();
  void solve_hard();
  void correct_interior();

  Mesh mesh_;
  Options options_;
  std::vector<Pin> pins_;
  std::vector<RigidField> rigid_;  ///< per part
  std::vector<char> bent_;         ///< per part: its pins ask for more than a rigid field can give
  std::optional<System> all_;      ///< of (7)
  std::optional<System> inside_;   ///< of (8), the interior vertices
  Worker worker_;
};

}  // namespace planar
