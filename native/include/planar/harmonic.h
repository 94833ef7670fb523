// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "planar/types.h"

namespace planar {

/// Values of some vertices of a mesh, spread over the others: the discrete harmonic function with natural
/// boundary conditions, Σ w_vu (x_v - x_u) = 0 at each vertex that is not held.
///
/// The weights are cotangents at rest, clamped at 0 where Delaunay's condition fails. So each value is a mean
/// of its neighbours', and none is beyond those that are held. Where all edges fulfil the condition, a linear
/// function on them is met. The system is factored once; each spread is a pair of triangular solves.
class Harmonic {
 public:
  /// \param rest n×2
  ///
  /// \param held k different vertices
  ///
  /// \throw std::invalid_argument mismatched, non-finite or out-of-range input
  ///
  /// \throw SolveError the system could not be factored
  Harmonic(const Points& rest, const Triangles& triangles, const Eigen::VectorXi& held);
  Harmonic(Harmonic&&) noexcept;
  Harmonic& operator=(Harmonic&&) noexcept;
  ~Harmonic();

  /// \param values k, of the held vertices
  ///
  /// \return n; 0 in parts with nothing held, and of vertices of no triangle that are not held
  ///
  /// \throw std::invalid_argument another number of values, or one that is not finite
  Eigen::VectorXd spread(const Eigen::VectorXd& values) const;

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace planar
