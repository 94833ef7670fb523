// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "mesh/orientation.h"
#include "planar/types.h"

namespace planar {

/// Has triangles that were turned over lie as at rest again: their neighbourhood goes to where its rest
/// energy is least, as HoldMethod finds it, and all else stays. Where that does not help, a wider
/// neighbourhood is tried; what is left then stays as it was, and so do all if they are so many that this
/// would be solving the whole mesh.
///
/// \param rest, x n×2, relative to `centre`
///
/// \param stiffness m factors, or empty
///
/// \param fixed n flags: vertices that stay
///
/// \param suspects triangles that may be turned over; the others are not looked at
///
/// \return the vertices that it moved
std::vector<int> turn_upright(const Points& rest, const Orientation& orientation,
                              const Eigen::RowVector2d& centre, const Eigen::VectorXd& stiffness,
                              const std::vector<char>& fixed, const std::vector<int>& suspects, Points& x);

}  // namespace planar
