// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "cage/carried_mesh.h"

namespace planar {

/// About `wished` vertices, evenly spread but for thin places (cage_sizes), by collapses of edges, flips to
/// Delaunay and smoothing towards centroids. What the mesh is like stays: parts, slits, holes, what overlaps.
/// Vertices that HalfEdges fixes stay where they are, with their triangles. Coarse vertices are in the order
/// of their sources.
/// \throw Cancelled progress returned false
Coarse coarsened(const Points& points, const Triangles& triangles, int wished,
                 const std::function<bool(double)>& progress = {});

}  // namespace planar
