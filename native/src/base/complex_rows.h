// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>

#include "planar/types.h"

namespace planar {

/// Points as numbers of the plane.
inline std::complex<double> complex_point(const Eigen::RowVector2d& p) { return {p.x(), p.y()}; }
inline std::complex<double> complex_row(const Points& x, Eigen::Index row) { return {x(row, 0), x(row, 1)}; }

}  // namespace planar
