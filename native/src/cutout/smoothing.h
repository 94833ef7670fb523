// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cutout/grid.h"
#include "planar/types.h"

namespace planar {

/// A triangulation whose first points are fixed.
struct PlanarMesh {
  Points points;
  Triangles triangles;
  Eigen::Index fixed = 0;  ///< points of the rings
};

/// Free points go to the mean of their triangles' centroids, weighted by area over squared size [Chen04], one
/// after the other; none leaves the outline.
void smooth_towards_centroids(PlanarMesh& mesh, const Grid<float>& distance, const Grid<float>& size);

/// Free points of triangles with small angles go where the smallest angle about them is largest, by a search
/// along the axes that halves its steps. Triangles keep their vertices and lie as they did.
void widen_angles(PlanarMesh& mesh);

}  // namespace planar
