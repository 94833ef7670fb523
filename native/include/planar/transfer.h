// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "planar/types.h"

namespace planar {

/// The motion of `frames` (f shapes of a source, n×2), made by another drawing with the same connectivity
/// [AIAP, section 5.1], which has `shape` (n×2) where the source has frames[0].
///
/// Each edge takes over the source's velocity, turned and scaled as the edge of `shape` is to the source's in
/// the first frame [AIAP 14]. [AIAP 15], with the first frame fixed and its velocity times the time step,
/// which is missing in print, is then met exactly: ẽ[k] = S̃ e[k]. Frames are assembled by [AIAP 10], with
/// weights 1/|ẽ| frozen at those of `shape`. The paper leaves translation out: here the centroid of each part
/// moves as the source's, turned and scaled as `shape` is to frames[0] as a whole. A motion transferred onto
/// its own first frame comes back.
///
/// \throw std::invalid_argument no frames, mismatched, non-finite or out-of-range input
///
/// \throw SolveError the frames cannot be assembled
std::vector<Points> transfer_motion(const std::vector<Points>& frames, const Points& shape,
                                    const Triangles& triangles);

/// The same for edges without faces.
std::vector<Points> transfer_motion(const std::vector<Points>& frames, const Points& shape,
                                    const Edges& edges);

}  // namespace planar
