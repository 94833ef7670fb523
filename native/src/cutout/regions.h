// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutout/grid.h"

namespace planar {

/// The pieces of a mask whose samples hang together by sides.
struct Regions {
  Grid<std::int32_t>
      region;  ///< of each sample, numbered from 0 in order of the samples; -1: not in the mask
  int count = 0;
};

Regions regions_of(const Mask& mask);

}  // namespace planar
