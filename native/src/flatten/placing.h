// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "flatten/patch.h"

namespace planar {

/// x (n×2) moved rigidly: its centroid, by the areas on the surface, to 0, and turned so that the edge from
/// `along[0]` to `along[1]` points along the positive x axis.
Points placed_by_edge(const Patch& patch, const Points& x, const std::array<int, 2>& along);

/// The same, but the direction in which x is longest, by its second moments, lies along the x axis, with the
/// edge pointing to its positive side, unless it is as long in all directions.
Points placed_by_length(const Patch& patch, const Points& x, const std::array<int, 2>& along);

}  // namespace planar
