// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "planar/handle.h"
#include "planar/types.h"

namespace planar {

enum class PoserMethod {
  hold,  ///< the pose of least distortion of the rest shape
  akvf,  ///< as-Killing-as-possible fields along logarithmic spirals; forgets the rest shape
  arap,  ///< as rigid as possible in two linear steps; turns triangles over in large poses
};

struct PoserOptions {
  PoserMethod method = PoserMethod::hold;
  std::optional<double> pin_weight{};  ///< μ (hold), λ² (akvf) or w (arap) of a pin, dimensionless, above 0;
                                       ///< by default the method's own
  Eigen::VectorXd stiffness{};  ///< m factors above 0 on the triangles' energy, or empty: all 1

  /// About so many vertices, 12 at least, of a coarse mesh to solve on in place of a larger one; empty: solve
  /// on the mesh itself. With hold and up to 150k vertices refine() and settle() end on the mesh itself.
  std::optional<int> cage{};

  /// Asked while a cage is made, which takes seconds for a million vertices.
  std::function<bool(double)> progress{};
};

/// What the last move(), refine() or settle() did.
struct Report {
  int iterations = 0;            ///< hold: Newton steps; akvf: steps towards the targets; arap: solves
  int substeps = 0;              ///< hold: steps that moved the mesh; akvf: pieces that steps were cut into
  double furthest_handle = 0.0;  ///< largest distance of a handle from its target, in the positions' unit
  int flipped = 0;               ///< triangles inverted relative to the rest shape, judged as in `distortion`

  /// hold: a full Newton step is at most 1e-5 of the rest's diameter, so that nothing is left to do,
  /// however far the handles are; akvf: furthest_handle is at most 1e-3 of that; arap: always, but
  /// for a settle() that ended before an iteration moved no vertex by more than 1e-5 of that
  bool converged = true;

  /// With a cage, hold: nothing is left to do on the coarse mesh. Unless converged, refine() goes on with the
  /// mesh itself, which takes longer.
  bool coarse_settled = false;
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
/// Method hold minimises
///
///   E(x) = Σ_t k_t A_t (|J|² + |J⁻¹|²) + Σ_i μ_i |p_i - target_i|²,   J: rest -> x,
///
/// the symmetric Dirichlet energy [Smith15] and a spring for each handle, and each joint, from the shape that
/// is shown: the pose depends on the handles and not on their path, as long as that does not lead into
/// another minimum (an arm wound the other way round). It descends by projected Newton: the Hessian of each
/// triangle without its negative eigenvalues [Smith19], one factor for several steps, each at most 0.8 of the
/// way to where a triangle collapses, with Armijo's rule. Departures and additions:
///
/// 1. A part whose handles' targets are a rigid motion of where they are, for the most part, makes that
/// motion first. It costs no energy, and Newton steps, being linear, would have to inflate what turns.
///
/// 2. Where a triangle would collapse within a tenth of a Newton step, the step is one in the metric of the
/// Killing energy of the mesh as it is [Claici17], which has the same sparsity.
///
/// 3. Where the energy falls along a step for longer than its Hessian expects, the step is prolonged, up to
/// ten times. Projection alone is too stiff under compression and near saddles, and takes a hundred steps to
/// settle then: near a minimum, where the Hessian itself is positive definite, steps are Newton's own; and
/// settle() takes truncated Newton steps, a few conjugate gradients of the Hessian itself with the projected
/// factor as preconditioner [Nocedal06].
///
/// 4. No triangle that lies as at rest is turned over, not even by rounding to float32: steps that would are
/// shortened. Triangles that are inverted in the positions given to reset() have the foldover-free energy of
/// [Garanzha21] until they come right. Where they do not, and where those positions go round an inner vertex
/// twice, which needs no inverted triangle and cannot be undone without one, the part begins anew from where
/// the rest shape comes nearest to its handles' targets.
///
/// 5. Triangles that nobody can see at rest, with an area below 1e-6 of the median one or an altitude below
/// 1e-3 of the median one, have no J to speak of and get springs instead; they stop no step.
///
/// 6. Parts that joints connect make the motion of 1 as one, and then each turns on its joints: rigid motions
/// that have the least sum of all springs, by Newton steps that close the joints before they are judged.
/// Where hinges leave motions free, vertices are drawn, by 1e-9 of a spring, to where they would be if all
/// that hangs together had moved as one from where it was when handles, joints or positions were set: the
/// pose does not depend on the path, and nothing drifts.
///
/// Handles do not always say how a part is to be turned: a single one does not, nor do handles in one place,
/// on targets in one place or mirrored. Then the fit of that motion (rigid_fit.h) turns nothing.
///
/// After a move, the factor for the next ones is made in a thread of the object's own, if it is due; the next
/// call waits for it. What is due is counted, not timed: results do not depend on threads.
///
/// Method akvf is the step of [AKVF], killing_field then advance_along_spirals, from where the
/// handles are to their targets, so that errors do not add up. Departures:
///
/// 1. A patch, or all handles of a part, whose targets are a turn of where they are get the velocities of
/// that turn; the differences would shrink what is turned.
///
/// 2. [AKVF 8] smooths point handles only, as it would lose the turn of a patch that lies inside.
///
/// 3. Triangles squeezed to less than about 0.38 of their rest width are stiffened, and where [AKVF 16] would
/// take 30 % of a triangle's area in a substep, its vertices share the mean of their factors φ. The paper's
/// step inverts triangles on most large poses.
///
/// 4. A part whose handles have further to go, on average, than the rest's box diagonal first makes that way
/// without any deformation: [AKVF 16] multiplies the way by factors φ that differ from vertex to vertex.
///
/// Method arap is arap_two_step (planar/arap.h) with cotangent weights: a move gives its whole result at
/// once, by back substitution alone; it depends on the handles only, not on where the mesh was. Stiffness
/// multiplies the cotangents. settle() goes on from there, by the local/global iterations of [Liu08] with a
/// rotation a triangle: the energy that the two steps approximate at its minimum. A later move gives the two
/// steps again. Nothing keeps triangles from turning over.
///
/// Sizes and places: positions are worked on relative to the middle of the rest shape, so that a rest far
/// from the origin is posed as one near it. Blender stores float32, which tells coordinates apart to 1/2²³ of
/// their size: at a distance of some 2²¹ times its height (two million) it can no longer keep a triangle from
/// turning over. Neither hold nor akvf takes a triangle that it judges (see Orientation) further than that:
/// moves end before their targets then, and report().converged is false. Triangles of a rest that lies so far
/// out itself, or whose size float32 does not have (1e-38 to 1e38), are not judged.
class Poser {
 public:
  /// μ, λ² or w of a pin when PoserOptions::pin_weight is empty; w is that of [ARAP09 1]. With hold, handles
  /// of twelve published poses of drawn characters end 0.0001 of the diagonal from their targets at 1000.
  /// With akvf, on these poses, 40 moves each, they end 0.0008-0.047 of the diagonal from their targets at λ²
  /// = 1, 0.0001-0.007 at 100, and no nearer above that; patches that are turned profit up to 1000.
  static constexpr double default_pin_weight = 1000.0;

  /// μ of a joint. Three characters cut into layers that are held together by patches of joints, and posed as
  /// published, are apart by at most 6e-6 of the diagonal at 10000.
  static constexpr double joint_weight = 1e4;

  /// \param rest n×2 rest shape, the reference of flips and tolerances, and the first positions
  /// \param triangles m×3
  /// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input
  /// \throw Cancelled options.progress returned false
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
  ///
  /// \throw SolveError arap, which factors here: a system could not be factored
  void set_handles(Handles handles, Eigen::VectorXd weights = {}, Eigen::VectorXi groups = {});

  /// Replaces all joints: k pairs of points of different parts that hang together (hold only). Positions and
  /// handles stay, targets are forgotten; the mesh is analysed anew. The two points of a pair are drawn into
  /// one place: a single pair is a hinge; several, which lie on each other at rest, hold parts as they lie.
  /// Parts without handles follow those with some that they hang on.
  ///
  /// \param strength k factors above 0 on joint_weight, or empty: all 1
  ///
  /// \throw std::invalid_argument a method other than hold; as killing_field for the points; a pair on one
  /// part; mismatched sizes or strengths not above 0
  ///
  /// \throw SolveError no memory
  void set_joints(const Handles& first, const Handles& second, const Eigen::VectorXd& strength = {});

  /// The handles towards `targets` (k×2), and the mesh with them. hold: two Newton steps with at most two
  /// factors made meanwhile; handles far from their targets may need more moves, refine() or settle(). akvf:
  /// one step, cut into substeps such that no triangle inverts and no edge turns or stretches by more than
  /// 15° (0.26) in one; at most 32 in a call. arap: both steps.
  ///
  /// \return the new positions (n×2), valid until the object changes
  ///
  /// \throw std::invalid_argument not k×2 or not finite
  ///
  /// \throw SolveError the field could not be solved
  const Points& move(const Points& targets);

  /// Repeats steps towards the last targets: hold until report().converged, at most 200; akvf until the
  /// handles stop getting nearer, at most 32; arap until an iteration moves no vertex by more than 1e-5 of
  /// the rest's diameter, at most 500. Without targets: nothing.
  ///
  /// \param progress asked where a mesh with a cage is solved itself
  /// \throw SolveError as move
  /// \throw Cancelled progress returned false
  const Points& settle(const std::function<bool(double)>& progress = {});

  /// One bounded piece of work towards the last targets, about as much as a move, in which no vertex moves by
  /// more than 2 % of the rest's diameter; report().converged says when nothing is left to do. arap
  /// leaves nothing to do. Without targets: nothing.
  ///
  /// \param progress as of settle
  /// \throw SolveError as move
  /// \throw Cancelled progress returned false
  const Points& refine(const std::function<bool(double)>& progress = {});

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
