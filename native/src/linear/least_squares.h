// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <limits>

namespace planar {

/// The X of least norm among those of least |A X - B|, for a dense A of any shape and rank, by a complete
/// orthogonal decomposition (in one source file, as it takes long to compile).
///
/// \param a n×m
///
/// \param b n×k
///
/// \param rounding pivots below this share of the largest are 0
///
/// \return m×k
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                              double rounding = std::numeric_limits<double>::epsilon());

}  // namespace planar
