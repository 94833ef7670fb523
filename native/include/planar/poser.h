// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "planar/handle.h"
#include "planar/types.h"

namespace planar {

enum class PoserMethod {
  hold,  ///< the pose of least distortion of the rest shape
  akvf,  ///< as-Killing-as-possible fields along logarithmic spirals; forgets the rest shape
};

struct PoserOptions {
  PoserMethod method = PoserMethod::hold;
  std::optional<double> pin_weight{};  ///< λ² of a pin, dimensionless, above 0; by default the method's own
  Eigen::VectorXd stiffness{};         ///< m factors above 0 on the triangles' energy, or empty: all 1
};

/// What the last move() or settle() did.
struct Report {
  int iterations = 0;            ///< steps towards the targets: 1 in move(), as many as it took in settle()
  int substeps = 0;              ///< pieces these steps were cut into; each is one field and one advance
  double furthest_handle = 0.0;  ///< largest distance of a handle from its target, in the positions' unit
  int flipped = 0;               ///< triangles inverted relative to the rest shape, judged as in `distortion`
  bool converged = true;         ///< furthest_handle is at most 1e-3 of the rest's box diagonal
};

/// Poses a mesh by dragging handles: registered with the rest shape, compiled with the handles, moved with
/// their targets.
///
/// \code
///   Poser poser(rest, triangles);
///   poser.set_handles(Handles::at_vertices(vertex, rest.rows()));
///   for (const Points& targets : path) show(poser.move(targets));
/// \endcode
///
/// The mesh's topology is analysed once; changing handles costs no new analysis.
///
/// Method akvf is the step of Solomon et al. 2011, killing_field then advance_along_spirals, from where the
/// handles are to their targets, so that errors do not add up. Departures:
///
/// 1. A patch, or all handles of a part, whose targets are a turn of where they are get the velocities of
/// that turn; the differences would shrink what is turned.
///
/// 2. (8) smooths point handles only, as it would lose the turn of a patch that lies inside.
///
/// 3. Triangles squeezed to less than about 0.38 of their rest width are stiffened, and where (16) would take
/// 30 % of a triangle's area in a substep, its vertices share the mean of their factors φ. The paper's step
/// inverts triangles on most large poses.
class Poser {
 public:
  /// λ² of a pin when PoserOptions::pin_weight is empty. On twelve published poses of drawn characters, 40
  /// moves each, handles end 0.0008-0.047 of the diagonal from their targets at λ² = 1, 0.0001-0.007 at 100,
  /// and no nearer above that; patches that are turned profit up to 1000.
  static constexpr double default_pin_weight = 1000.0;

  /// \param rest n×2 rest shape, the reference of flips and tolerances, and the first positions
  /// \param triangles m×3
  /// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input
  explicit Poser(Points rest, const Triangles& triangles, const PoserOptions& options = {});
  Poser(Poser&&) noexcept;
  Poser& operator=(Poser&&) noexcept;
  ~Poser();

  /// Replaces all handles; positions stay.
  ///
  /// \param weights k factors above 0 on pin_weight, or empty: all 1
  ///
  /// \param groups k labels, or empty: all different. Handles with equal labels are one pin (a patch) and
  /// share its weight.
  ///
  /// \throw std::invalid_argument as killing_field for the handles, else mismatched sizes or weights not
  /// above 0
  void set_handles(Handles handles, Eigen::VectorXd weights = {}, Eigen::VectorXi groups = {});

  /// One step of the handles towards `targets` (k×2), and of the mesh with them. The step is cut into
  /// substeps such that no triangle inverts and no edge turns or stretches by more than 15° (0.26) in one; at
  /// most 32 in a call.
  ///
  /// \return the new positions (n×2), valid until the object changes
  ///
  /// \throw std::invalid_argument not k×2 or not finite
  ///
  /// \throw SolveError the field could not be solved
  const Points& move(const Points& targets);

  /// Repeats steps towards the last targets until the handles stop getting nearer, at most 32 steps. Without
  /// targets: nothing.
  ///
  /// \throw SolveError as move
  const Points& settle();

  /// One bounded piece of work towards the last targets, about as much as a move, in which no vertex moves by
  /// more than 2 % of the rest's box diagonal; report().converged says when nothing is left to do. Without
  /// targets: nothing.
  ///
  /// \throw SolveError as move
  const Points& refine();

  /// Back to the rest shape. Handles stay, targets are forgotten.
  void reset();

  /// Continues from `positions` (n×2). Handles stay, targets are forgotten.
  /// \throw std::invalid_argument not n×2 or not finite
  void reset(const Points& positions);

  const Points& positions() const;
  const Report& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace planar
