// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutout/grid.h"

namespace planar {

/// Of each sample the nearest one of some sites.
struct NearestSites {
  Grid<float> distance;     ///< in samples, at most `reach`
  Grid<std::int32_t> site;  ///< its index in the grid, -1 beyond the reach
};

/// The exact Euclidean distance to the nearest site, by lower envelopes of parabolas row by row
/// [Felzenszwalb12]. What is further than `reach` is not looked for, which is most of the work where the
/// reach is short: only columns with a site within the reach take part in a row.
NearestSites nearest_sites(const Mask& sites, double reach);

/// The distance alone.
Grid<float> distance_to(const Mask& sites, double reach);

}  // namespace planar
