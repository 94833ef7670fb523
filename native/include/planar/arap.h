// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/handle.h"
#include "planar/types.h"

namespace planar {

enum class ArapWeights {
  cotangent,  ///< ½ Σ cot(opposite angle), clamped at 0
  uniform,    ///< 1 an edge
};

/// The two steps of [ARAP09], n×2 each.
struct ArapSteps {
  Points similar;  ///< similar to the rest as far as the handles allow; the scale is free
  Points final;    ///< with edges of the rest's lengths, as far as they allow
};

/// The mesh at `rest` (n×2) with its handles at `targets` (k×2), as rigid as possible in two linear steps.
/// The result depends on these alone, not on a path; large poses turn triangles over.
///
/// Step 1 minimises Σ w |(v_j - v_i) - T e|² + handle_weight Σ |handle - target|² over the edges e of the
/// rest, T the similarity from the 3 or 4 corners of the edge's triangles at rest to where they are [ARAP09
/// 3-5]; step 2 the same for T/|T| of that result [ARAP09 6, 7].
///
/// Departures: T maps differences from the corners' mean (as printed the result depends on the origin), and
/// is normalised by its length (T/|T|² as printed is no rotation); w is the weight of an edge in the energy
/// (multiplied to its row as printed it would be squared). Edges with more than two triangles take the first
/// two. Pieces that meet in one vertex are braced there by a thousandth of an edge.
///
/// A connected part without a handle stays; a part whose handles all lie at one point (closer than 5e-6 of
/// the rest's diameter) is moved, not turned; handles at the very same point of the mesh count as one, with
/// the mean of their targets; isolated vertices stay. Where step 1 collapses, with all targets in one place,
/// edges keep their direction.
///
/// \param handle_weight dimensionless, above 0
///
/// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input; handles not inside a
/// triangle
///
/// \throw SolveError a system could not be factored, or the result is not finite
ArapSteps arap_two_step(const Points& rest, const Triangles& triangles, const Handles& handles,
                        const Points& targets, double handle_weight = 1000.0,
                        ArapWeights weights = ArapWeights::cotangent);

}  // namespace planar
