// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace planar {

/// The rotation R with the largest tr(R S), S = Σ w p qᵀ over points p that are to go to q. Where that does
/// not say (S = 0), one of those that do as well.
Eigen::Matrix2d nearest_rotation(const Eigen::Matrix2d& s);
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& s);

}  // namespace planar
