// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "planar/types.h"

namespace planar {

/// A frame that was changed by hand.
struct FrameEdit {
  int frame;
  Points shape;  ///< n×2
};

/// Spreads changes of single frames over the sequence they are in [AIAP, section 5.2]: edited frames are as
/// given, and the others keep their motion. With one edit it is the transfer from its frame on, both ways in
/// time. Between two edits the change of each edge, its turn and scale, goes evenly from one to the other;
/// before the first and after the last it stays. Parts are shifted likewise.
///
/// \param edits in any order; without any the frames come back
///
/// \throw std::invalid_argument no frames, mismatched, non-finite or out-of-range input, a frame edited twice
///
/// \throw SolveError the frames cannot be assembled
std::vector<Points> edit_sequence(const std::vector<Points>& frames, const std::vector<FrameEdit>& edits,
                                  const Triangles& triangles);

/// The same for edges without faces.
std::vector<Points> edit_sequence(const std::vector<Points>& frames, const std::vector<FrameEdit>& edits,
                                  const Edges& edges);

}  // namespace planar
