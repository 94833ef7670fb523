// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <random>

#include "planar/types.h"

/// Pieces of surface to lay flat.
namespace planar::testing {

struct Surface {
  SpacePoints vertices;
  Triangles triangles;
};

/// A grid of columns×rows vertices of a rectangle, u and v from 0 to the given sizes, each taken to space.
using Embedding = std::function<Eigen::RowVector3d(double u, double v)>;
Surface sheet(int columns, int rows, double width, double height, const Embedding& embed);

/// What the sheet is before it is taken to space: n×2.
Points unrolled_sheet(int columns, int rows, double width, double height);

/// The part of the unit sphere within `angle` of its pole, in rings of six more vertices each.
Surface cap(int rings, double angle);

/// A tube, `around` vertices a ring, one edge long between rings, closed at its upper end by one vertex.
Surface sleeve(int around, int rings);

/// The surface without these triangles, and without vertices that only they had.
Surface without(const Surface& surface, const std::function<bool(int triangle)>& left_out);

/// The surface cut along a path of vertices, which are doubled: one after another they share edges, the first
/// one is on the boundary, and the last one stays single.
Surface cut(const Surface& surface, const std::vector<int>& path);

/// Mean area and angle distortion from the surface to x, and triangles that are turned over, judged on
/// float32; needles and specks (altitude below 1e-3 of the median, area below 1e-6) are not counted.
struct Flatness {
  double area, angle;
  int flipped;
};
Flatness flatness(const Surface& surface, const Points& x);

/// The largest distance of two points that the rigid motion nearest to x -> y leaves.
double apart(const Points& x, const Points& y);

}  // namespace planar::testing
