// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutout/art_mask.h"
#include "cutout/grid.h"
#include "planar/types.h"

namespace planar {

/// The margin where none is given.
constexpr double margin_of_edge = 0.1;

/// What the outline's place is made from. All lengths are in samples.
struct OutlineField {
  /// Signed distance to the outline, positive inside, exact near it and up to `reach`; with a border in which
  /// everything is outside.
  Grid<float> distance;
  Grid<std::int32_t> foot;  ///< nearest sample of the outside, for what is inside; -1 beyond the reach
  int border;               ///< samples beyond the image on each side
  double sample;            ///< pixels

  double edge, margin, rounding;

  int dropped_islands;
  Eigen::Index dropped_samples;
  int filled_holes;

  /// From samples to pixels of the image.
  Points to_pixels(const Points& points) const { return (points.array() - border + 0.5).matrix() * sample; }
};

/// \param reach how far inside distances are of interest, in edges
OutlineField outline_field(const ArtMask& art, const CutoutOptions& options, double reach);

}  // namespace planar
