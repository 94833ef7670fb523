// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "energy/killing_energy.h"
#include "energy/rest_energy.h"
#include "inbetween/blended_triangles.h"
#include "linear/sparse_solver.h"
#include "mesh/mesh.h"
#include "mesh/orientation.h"
#include "parallel/per_thread.h"

namespace planar {

/// Takes frames in which triangles are flipped to near ones in which none is: minimises
///
///   4u(1-u) E_u(x) + w Σ m |x - y|²
///
/// from a shape without flips, with y the frame at u, E_u the rest energy of the keys' blended triangles, m
/// an equal share of the area and w = 10 / (diagonal/50)². E_u is least at the keys for the keys themselves,
/// so that the solution leaves y slowly; with the factor before it it even has the velocities of y there. By
/// projected Newton steps, in the Killing metric where a triangle blocks them. Those of E_u alone are to be
/// had as well.
class FrameTracker {
 public:
  /// For the threads of a team, which must not share one.
  static PerThread<FrameTracker> one_a_thread(const ThreadTeam& team, const Triangles& triangles,
                                              const Points& from, const Points& to);

  /// \param triangles of the parts to work on; other vertices stay
  FrameTracker(const Triangles& triangles, const Points& from, const Points& to);

  /// The minimum for the frame y at u, from the solution x of a frame `of` near to it, until a step is at
  /// most `settled` of the keys' diagonal. \throw SolveError numbers overflow
  Points follow(const Points& x, const Points& of, const Points& y, double u, double settled);

  /// A projected Newton step of E_u alone.
  struct Step {
    Points direction;
    double collapse = 0.0;  ///< the least t at which x + t direction has a triangle without area
    double energy = 0.0;    ///< E_u(x); not finite where a triangle is flat
    double slope = 0.0;     ///< of E_u along direction
  };
  /// From x without flips. Places, which the energy does not tell, hardly change.
  /// \throw SolveError the Hessian cannot be factorized
  Step step_at(const Points& x, double u);
  double energy_of(const Points& x, double u) const { return energy_at(u).value(x); }

  /// Of the triangles, the mean of both keys: energies are known to a share of it.
  double area() const { return area_of_keys_; }

 private:
  Points predicted(const Points& x, const Points& of, const Points& y) const;
  void minimise(double settled, Points& x);
  RestEnergy energy_at(double u) const;
  double value(const Points& x) const { return scale_ * energy_.value(x) + pull_ * (x - y_).squaredNorm(); }
  void solve(bool killing, const Points& x, double pull);
  bool keeps_upright(const Points& x);

  Mesh mesh_;
  std::vector<char> parts_;  ///< all of them, in the form that matrices take
  std::unique_ptr<SparseSolver> solver_;
  KillingMatrix matrix_;
  Orientation orientation_;
  BlendedTriangles blended_;
  double diagonal_;
  double area_of_keys_;  ///< their mean
  double pull_;          ///< w m

  // Of the frame under way.
  RestEnergy energy_;
  double scale_ = 0.0;  ///< of energy_
  Points y_, gradient_, direction_, trial_;
  Eigen::VectorXd unknown_;
  std::vector<double> area_, trial_area_;
};

}  // namespace planar
