// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <functional>
#include <limits>
#include <vector>

#include "energy/newton_system.h"
#include "energy/rest_energy.h"
#include "mesh/mesh.h"
#include "mesh/orientation.h"

namespace planar {

/// The one descent: minimises scale · E(x) + springs, E the rest energy of a mesh, from any x.
///
/// Steps are Newton's with the projected Hessian, whose factor serves several of them; at most 0.8 of the way
/// to where a triangle collapses, by Armijo's rule, and prolonged where the energy falls for longer than its
/// Hessian expects. No triangle that lies as at rest when it begins is turned over, not even by rounding to
/// float32. Where a triangle would collapse within a tenth of a step, the step is one in the metric of the
/// Killing energy of the mesh as it is [Claici17]. Projection is too stiff under compression and where limbs
/// bend: near a minimum, where the Hessian has no need of it, steps are Newton's own; and descents that no
/// event waits for go by truncated Newton steps, in which conjugate gradients, preconditioned by the
/// projected factor, give the Hessian its negative curvature back [Nocedal06].
///
/// What is done is counted, never timed: equal input gives equal bits.
class Newton {
 public:
  struct Budget {
    int steps;
    int factors;
    bool ahead;    ///< the caller makes the next factor after the last step (see due()); factors get older
    double limit;  ///< to how far a vertex may move from where it was at begin()
    double tolerance;                     ///< with a full step of at most this, nothing is left to do
    std::function<void()> before_step{};  ///< what it throws ends the descent
  };
  struct Outcome {
    int iterations = 0;      ///< steps tried
    int steps = 0;           ///< steps that moved the mesh
    bool converged = false;  ///< nothing is left to do
  };

  /// \param mesh, springs, orientation must outlive this
  /// \param stiffness m factors, or empty
  /// \param size of the mesh: lengths are small or large beside it
  Newton(const Mesh& mesh, const Springs& springs, const Eigen::VectorXd& stiffness,
         const Orientation& orientation, double size);

  NewtonSystem& system() { return system_; }
  const NewtonSystem& system() const { return system_; }
  const RestEnergy& rest_energy() const { return energy_; }
  double size() const { return size_; }

  /// The next descent begins anew, wherever the last one has come to.
  void forget() noexcept;

  /// What is minimised from now on. The factor stays, if there is one.
  void set_energy(RestEnergy energy, double scale);

  double value(const Points& x) const {
    return scale_ * energy_.value(x) + system_.springs().value(x, nullptr);
  }

  /// x is where the next descent starts from, though the caller may move it before, keeping it upright.
  void begin(const Points& x);
  /// No triangle that lay as at rest at begin() does so no longer, as float32.
  bool keeps_upright(const Points& x);
  /// Moves x down.
  /// \throw SolveError numbers overflow
  Outcome descend(const Budget& budget, Points& x);

  /// A factor made after the last step would be of use to the next descent.
  bool due() const;
  /// Makes it, in any thread, but nothing else meanwhile. It may fail, and then there is none.
  void renew_ahead(const Points& x) noexcept;

  /// A step from x and what it comes to.
  struct Step {
    double value = 0.0;     ///< what is minimised, at x; not finite where a triangle is without area
    double slope = 0.0;     ///< of it along the direction
    double length = 0.0;    ///< of the longest displacement of a vertex, for t = 1
    double collapse = 0.0;  ///< the t at which a triangle collapses
    double t = 0.0;         ///< of it was taken
  };
  /// A step with a new projected factor, not taken.
  /// \throw SolveError the Hessian cannot be factorized
  Step step_at(const Points& x, Points& direction);

  /// Armijo's rule: whether `reached` is low enough for having gone t along a slope. `error` is what values
  /// may be off by.
  static bool lessens(double value, double reached, double t, double slope, double error);

 private:
  double gradient(const Points& x);
  bool has_hessian() const;
  void renew(const Points& x);
  void aim(const Points& x, Step& step);
  void measure(const Points& x, Step& step) const;
  void search(double longest, Points& x, Step& step);

  NewtonSystem system_;
  const Orientation& orientation_;
  RestEnergy energy_;
  double scale_ = 1.0;  ///< of energy_
  double size_;

  // Of the factor.
  int age_ = 0;               ///< steps taken with it
  double last_length_ = 0.0;  ///< of the step before with it, infinite if that was not a full one
  /// The same of the step before with any, until forget().
  double last_motion_ = std::numeric_limits<double>::infinity();

  // Of the descent under way.
  Points start_, gradient_, direction_, trial_, further_;
  std::vector<double> area_, trial_area_;
};

}  // namespace planar
