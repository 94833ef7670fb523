// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/types.h"

namespace planar {

/// Distortion of a map of triangles [AKVF, section 3.3]. With σ₁, σ₂ the singular values of a
/// triangle's Jacobian: area σ₁σ₂ + 1/(σ₁σ₂), angle σ₁/σ₂ + σ₂/σ₁; both are 2 at best and infinite when the
/// triangle collapses.
struct Distortion {
  double area;                     ///< mean of triangle_area by rest area
  double angle;                    ///< mean of triangle_angle by rest area
  int flipped;                     ///< triangles with det J < 0
  Eigen::VectorXd triangle_area;   ///< m values
  Eigen::VectorXd triangle_angle;  ///< m values
  Flags triangle_flipped;          ///< m values
};

/// Distortion from `rest` (n×2) to `posed` (n×2). Flips are judged on positions rounded to float32, which is
/// what Blender stores. Triangles that nobody can see at rest (area below 1e-6 of the median one of their
/// part, or altitude below 1e-3 of the median one, or below what float32 tells) have no Jacobian to speak of:
/// they count as undistorted (2), with no weight in the means, and not flipped.
///
/// \throw std::invalid_argument mismatched, non-finite or out-of-range input; numbers beyond float32's
Distortion distortion(const Points& rest, const Points& posed, const Triangles& triangles);

}  // namespace planar
