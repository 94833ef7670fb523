// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "support.h"

/// Triangles that nobody can see, as a constrained Delaunay triangulation of a traced outline has them.
namespace planar::testing {

double area_of(const Points& x, const std::array<int, 3>& t);

/// The shape with about a sixth of its triangles more, of which a person sees none: caps along edges and
/// needles between near-duplicate points. About 1 % of all triangles have less than 1e-13 of the median area,
/// 10 % less than 1e-5 of it, the rest of the new ones up to a hundredth. The shape's vertices come first,
/// most of them where they were. All triangles lie counter-clockwise.
Shape with_slivers(const Shape& shape, unsigned seed);

/// Vertices far from each other, and where they go: every other one by up to a quarter of the diagonal.
struct Drag {
  std::vector<int> pins;
  Points start, targets;
};

Drag random_drag(const Shape& shape, unsigned seed, double furthest = 0.25);

}  // namespace planar::testing
