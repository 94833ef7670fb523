// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cutout/grid.h"
#include "planar/types.h"

namespace planar {

/// The curves along which `values` is zero, by marching squares: closed, what is above zero on their left.
/// The grid's outermost samples must not be above zero.
std::vector<Points> zero_contours(const Grid<float>& values);

/// Points at even steps of about `step` along a closed polyline, 12 at least.
Points even_ring(const Points& ring, double step);

/// A list of points as n×2.
Points rows_of(const std::vector<Eigen::RowVector2d>& points);

double perimeter(const Points& ring);

/// Above 0: counter-clockwise.
double signed_area(const Points& ring);

}  // namespace planar
