// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "planar/types.h"

namespace planar {

/// Handles that may move as one: all of a part, or those of a patch.
struct MovingTogether {
  std::vector<int> rows;
  bool always;  ///< a patch; else only if their targets are a rigid motion of where they are
};

/// Velocities (k×2) that take handles in unit time from where they are (k×2) to their targets (k×2). They are
/// the differences [AKVF, section 2.4], except for handles that move together: those get the
/// velocities of the rigid motion nearest to their targets, and the differences for what it leaves. The
/// differences alone would shrink a patch that is turned, by 3 % at 15° and to a point at 180°. Of several
/// sets with a handle the first one that applies counts for it; what a set's motion is does not depend on
/// that.
Points velocities_towards(const Points& from, const Points& to, const std::vector<MovingTogether>& sets);

}  // namespace planar
