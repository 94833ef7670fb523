// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "flatten/patch.h"

namespace planar {

/// Tutte's map of a patch [Tutte63]: the outer boundary on a circle of the patch's area, by its lengths, and
/// each vertex inside at the weighted mean of its neighbours; a hole is filled with a fan round a vertex
/// more. Whatever the weights, no triangle is turned over, but for rounding errors.
///
/// With equal weights the rings of a sleeve shrink exponentially, towards what float64 does not tell. Where
/// that makes triangles small, shortest paths from the boundary, in which no ring pulls another one inward,
/// get larger weights than all other edges, by the square of their number of edges: then rings shrink about
/// evenly.
///
/// \return n×2, counter-clockwise, about 0; vertices of no triangle at 0
/// \throw SolveError the system could not be factored
Points tutte_map(const Patch& patch);

}  // namespace planar
