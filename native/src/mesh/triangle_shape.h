// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/types.h"

namespace planar {

/// Twice the signed area of a triangle (three vertex indices) at x.
double doubled_area(const Points& x, const int* corner);

/// Whether the triangle at x is thicker than what rounding to float32, which is what Blender stores, makes of
/// its coordinates, so that rounding cannot turn it over.
bool float32_tells(const Points& x, const int* corner);

/// The one rule of which triangles are flat: those that nobody can see. They have no usable Jacobian or one
/// of rounding errors; for every method they neither stop a step nor steer one, and nobody asks which way
/// round they lie.
///
/// A triangle is flat at `rest` if its area is below 1e-6 of the median area, or its least altitude below
/// 1e-3 of the median one, or if float32 does not tell it from one without area. The medians are those of its
/// connected part, over the triangles that are more than rounding errors: a layer may be as fine as it likes
/// beside another, and a strip all of whose triangles are thin is measured by itself. They are medians by
/// number, as a finer region of a part has most of its triangles. A part so far from the origin that float32
/// tells nothing of it is judged by area and altitude alone.
///
/// \param rest n×2
/// \param triangles m×3, indices in range
/// \return m flags
Flags flat_triangles(const Points& rest, const Triangles& triangles);

/// The same of a surface in space (n×3).
Flags flat_triangles(const SpacePoints& rest, const Triangles& triangles);

}  // namespace planar
