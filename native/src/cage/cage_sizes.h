// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cage/half_edges.h"

namespace planar {

/// Lengths of a cage's edges at the vertices of a dense mesh (n): as long as gives about `wished` vertices,
/// shorter where the mesh is thin, 1.1 times the distance to its boundary on its medial axis, growing by 0.35
/// of the distance from there. Distances are within the mesh: parts that touch or overlap do not see each
/// other.
std::vector<double> cage_sizes(const Points& points, const HalfEdges& mesh, int wished);

}  // namespace planar
