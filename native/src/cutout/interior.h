// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutout/grid.h"
#include "planar/types.h"

namespace planar {

/// Points inside of the outline: hexagonal lattices of all sizes from `longest` to `shortest`, coarse ones
/// first, of which a point stays where the size is that of its lattice and no other is near.
///
/// \param boundary points that are there before
Points interior_points(const Points& boundary, const Grid<float>& distance, const Grid<float>& size,
                       double shortest, double longest);

/// Points for the gaps that lattices leave between each other and the outline: centres of empty circles of a
/// Delaunay triangulation, where the size is that of the gap.
Points gap_points(const Points& points, const Triangles& triangles, const Grid<float>& distance,
                  const Grid<float>& size, double longest);

}  // namespace planar
