// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "planar/types.h"

namespace planar {

/// The rigid motion nearest to what the pins of a part ask for: p -> target + e^{i angle} (p - centre).
struct RigidMotion {
  double weight = 0.0;  ///< the pins' strengths; 0 without pins
  std::complex<double> centre = 0.0, target = 0.0;
  double angle = 0.0;
  double before = 0.0, after = 0.0;  ///< Σ strength |pin - its target|² without and with it

  /// The motion up to a share of it, from 0 to 1.
  std::complex<double> at(const std::complex<double>& p, double share) const {
    return centre + share * (target - centre) + std::polar(1.0, share * angle) * (p - centre);
  }
};

/// Where a pin is.
Eigen::RowVector2d pinned_point(const Pin& pin, const Points& x);

/// For each part the motion of x towards its pins' targets (Pin::position).
std::vector<RigidMotion> fit_rigid_motions(const Mesh& mesh, const std::vector<Pin>& pins, const Points& x);

}  // namespace planar
