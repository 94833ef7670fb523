// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "killing_energy.h"
#include "mesh.h"
#include "orientation.h"
#include "rest_energy.h"
#include "sparse_solver.h"

namespace planar {

/// Takes frames in which triangles are flipped to near ones in which none is: minimises
///
///   (1-u) E_from(x) + u E_to(x) + w Σ m |x - y|²
///
/// from a shape without flips, with y the frame at u, E_from and E_to the rest energies of the two keys, m an
/// equal share of the area and w = 10 / (diagonal/50)². At the keys it leaves y as it is, and its minimum
/// moves with y. By projected Newton steps, in the Killing metric where a triangle blocks them.
class FrameTracker {
 public:
  /// \param triangles of the parts to work on; other vertices stay
  FrameTracker(const Triangles& triangles, const Points& from, const Points& to);

  /// Takes x, in which no triangle is flipped, to the minimum for the frame y at u, until a step is at most
  /// `settled` of the keys' diagonal.
  /// \throw SolveError numbers overflow
  void follow(const Points& y, double u, double settled, Points& x);

  /// Where to start for y from the solution `x` of a frame `of` near to it: moved as from `of` to y, rigidly
  /// where more would collapse a triangle. Vertices of other parts are y's.
  Points predicted(const Points& x, const Points& of, const Points& y) const;

 private:
  double value(const Points& x) const;
  double value_and_gradient(const Points& x);
  void solve(bool killing, const Points& x);
  bool keeps_upright(const Points& x);

  Mesh mesh_;
  std::vector<char> parts_;  ///< all of them, in the form that matrices take
  std::unique_ptr<SparseSolver> solver_;
  KillingMatrix matrix_;
  Orientation from_orientation_, to_orientation_;
  RestEnergy from_energy_, to_energy_;
  double diagonal_;
  double pull_;  ///< w m

  // Of the frame under way.
  double u_ = 0.0;
  Points y_, gradient_, other_gradient_, direction_, trial_;
  Eigen::VectorXd unknown_;
  std::vector<double> area_, trial_area_;
};

}  // namespace planar
