// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "planar/types.h"

namespace planar {

/// The constrained Delaunay triangulation of points, by CGAL with exact predicates: counter-clockwise
/// triangles of what the rings enclose an odd number of times. Points in the place of one before them are in
/// no triangle.
///
/// \param points n×2, finite; those of the rings first, ring by ring
/// \param rings points of each ring
///
/// \throw SolveError rings that cross each other, or themselves
Triangles constrained_delaunay(const Points& points, const std::vector<int>& rings);

}  // namespace planar
