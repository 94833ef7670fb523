// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "energy/killing_energy.h"
#include "linear/sparse_solver.h"
#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "parallel/worker.h"
#include "planar/handle.h"

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
  /// \param patch k flags, or empty: handles that [AKVF 8] is not to smooth away. Smoothing is for handles
  /// that pull at a single point of the interior; a patch spreads its pull, and [AKVF 8] would lose the turn
  /// of a patch that lies inside.
  ///
  /// \throw std::invalid_argument a handle is not inside a triangle, edge or vertex of the mesh
  std::vector<Pin> compile(const Handles& handles, const Eigen::VectorXd& weights,
                           const std::vector<char>& patch = {});
  void use(std::vector<Pin> pins) noexcept;

  /// Factors the systems of the mesh at x (n×2, finite) with `stiffness` (m, or empty: all 1) for the handles
  /// in use. Returns at once: the work is done by two threads, or by solve() for small meshes. Called when
  /// the positions are known, it costs the time until the velocities are known nothing. Only what is
  /// computed counts, never when, so that results do not depend on it.
  void prepare(const Points& x, const Eigen::VectorXd& stiffness);

  /// Whether the last prepare() was at x, for the handles in use.
  bool is_prepared(const Points& x) const { return prepared_ && x == x_; }

  /// The field (n×2) of the prepared mesh for handle velocities (k×2), all finite. See killing_field.
  ///
  /// \pre prepare() since the last use(), and since a solve() that failed
  ///
  /// \throw SolveError the systems could not be factored, or the field is not finite
  void solve(const Points& velocities, Points& field);

  const Mesh& mesh() const { return mesh_; }

 private:
  /// The rigid field mean + rate·R90·(p - centre) nearest to a part's pin velocities.
  struct RigidField {
    Eigen::RowVector2d centre, mean;
    double rate;
    double weight, inertia;  ///< of the pins, about the centre
    Eigen::RowVector2d at(const Eigen::RowVector2d& p) const {
      return {mean.x() - rate * (p.y() - centre.y()), mean.y() + rate * (p.x() - centre.x())};
    }
  };

  /// A Killing matrix over some vertices, in an order that keeps its factor sparse.
  struct System {
    System(const Mesh& mesh, std::vector<int> kept, Backend backend);
    /// Lets `factor` be done by the worker, or for small meshes by finish().
    void start(std::function<void()> factor);
    /// Waits for it and throws what it threw.
    void finish();
    std::unique_ptr<SparseSolver> solver;
    KillingMatrix killing;
    Eigen::VectorXd unknown;
    bool in_worker;
    std::function<void()> factor_later;
    Worker worker;
  };

  void wait() noexcept;
  /// Hard handles all count alike, in what is rigid and in solve_hard's A = K + CᵀC.
  double strength(const Pin& pin) const { return options_.hard ? 1.0 : pin.strength; }
  void fit_centres();
  void fit_rigid_fields(const Points& velocities);
  bool is_smoothed(const Pin& pin) const;
  void factor_all();
  void factor_inside();
  void solve_soft();
  void solve_hard();
  void correct_interior();

  Mesh mesh_;
  Options options_;
  std::vector<Pin> pins_;
  Points x_;  ///< prepared for
  Eigen::VectorXd stiffness_;
  bool prepared_ = false;
  std::vector<RigidField> rigid_;  ///< per part
  std::vector<char> bent_;         ///< per part: its pins ask for more than a rigid field can give
  bool any_bent_ = false;
  bool correct_ = false;          ///< [AKVF 8] changes something
  std::optional<System> all_;     ///< of [AKVF 7]
  std::optional<System> inside_;  ///< of [AKVF 8], the interior vertices
};

}  // namespace planar
