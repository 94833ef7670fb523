// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "planar/cutout.h"

namespace planar::testing {

/// An image that is opaque where `inside` says so of a pixel's centre.
AlphaImage drawn(int width, int height, const std::function<bool(double, double)>& inside);

/// Discs, strokes, noise and blocks, with holes: another image for each seed.
AlphaImage random_art(unsigned seed);

/// Pixels above `threshold` of which a corner or the centre is enclosed by an even number of rings.
int lost_pixels(const AlphaImage& alpha, const std::vector<Points>& rings, double threshold);

/// The rings of a mesh as polygons.
std::vector<Points> polygons(const Cutout& cutout);

double area_of(const std::vector<Points>& rings);

/// Degrees.
double smallest_angle(const Points& points, const Triangles& triangles);

}  // namespace planar::testing
