// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "support.h"

/// Dense meshes that a cage is made for.
namespace planar::testing {

/// Each triangle cut into four, `times` over; the vertices of before come first.
Shape refined(Shape shape, int times = 1);

/// A grid of side×side vertices (odd) that is slit from the middle of its upper edge to its centre: the two
/// legs touch.
Shape slit_grid(int side);

/// The vertices of slit_grid's two legs, above its middle, left and right.
std::vector<int> leg(const Shape& slit, bool left);

/// A strip that goes round in a spiral of 1.5 turns whose windings lie on each other.
Shape overlapping_strip(int columns, int rows);

}  // namespace planar::testing
