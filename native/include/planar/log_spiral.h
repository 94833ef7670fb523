// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/types.h"

namespace planar {

/// Positions (n×2) after the vertices have followed `velocities` (n×2) for a unit of time along logarithmic
/// spirals [AKVF 14-16]: each vertex goes to the mean over its edges of p +
/// u·φ(z), with complex z = (u_p - u_q)/(p - q) and φ(z) = (e^z - 1)/z. That is [AKVF 14-16] without their
/// pole at translations. A rigid field moves the mesh rigidly, at any angle. An edge of no length (below
/// 1e-12 of the longest one) counts as a translation; vertices without edges stay, as they have no spiral.
///
/// \throw std::invalid_argument mismatched, non-finite or out-of-range input
/// \throw SolveError the spirals leave the range of double (e^z overflows)
Points advance_along_spirals(const Points& vertices, const Triangles& triangles, const Points& velocities);

}  // namespace planar
