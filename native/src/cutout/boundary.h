// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutout/size_field.h"

namespace planar {

/// Points of an even ring (ring_step) about as far apart as the sizes where they lie, 6 at least, such that
/// the straight lines between them stay in the band.
Points boundary_polygon(const Points& ring, const Grid<float>& distance, const Grid<float>& size,
                        const Band& band);

}  // namespace planar
