// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/types.h"

namespace planar {

/// The size of a shape: the largest distance of two of its points (n×2). Unlike a box's diagonal it is the
/// same for the shape turned, and it is not larger than that. 0 of no points.
double diameter(const Points& points);

}  // namespace planar
