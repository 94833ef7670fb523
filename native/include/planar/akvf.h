// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/handle.h"
#include "planar/types.h"

namespace planar {

struct KillingOptions {
  double pin_weight = 1.0;      ///< λ² of [AKVF 7], dimensionless, above 0; unused when `hard`
  bool hard = false;            ///< handles are constraints instead of weights: [AKVF 7] as λ → ∞
  bool dirichlet = true;        ///< also solve [AKVF 8]: the same boundary, and smooth at handles inside
  Eigen::VectorXd stiffness{};  ///< m factors above 0 on the triangles' energy, or empty: all 1
};

/// As-Killing-as-possible vector field [AKVF 7, 8]: n×2 velocities of the
/// mesh at `vertices` (n×2) whose deformation is as near to rigid as the handles' velocities (k×2) allow.
///
/// A connected part without a handle gets velocity 0; a part whose handles all lie at one point (closer than
/// 1e-6 of the mesh's diameter) translates with their mean velocity; handles at the very same point of
/// the mesh count as one, with the mean of their velocities; isolated vertices stay. When no handle lies on
/// an interior vertex, [AKVF 8] changes nothing and is not solved. Linearly dependent hard handles (four in a
/// triangle) are met in the sense of least squares.
///
/// Departures from the paper: rows of P per triangle as √A·[2Gx 0; √2·Gy √2·Gx; 0 2Gy], since [AKVF 2] is an
/// integral and the printed rows give even a rotation energy; triangles flatter than 1e-5 of their longest
/// edge squared are stiffened as if they had that area, because the printed energy divides by it; parts of a
/// mesh that only meet in one vertex are braced there by a thousandth of the stiffness of the missing
/// triangle, because a free hinge makes [AKVF 7] singular.
///
/// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input; handles not inside a
/// triangle
///
/// \throw SolveError the system could not be factored
Points killing_field(const Points& vertices, const Triangles& triangles, const Handles& handles,
                     const Points& velocities, const KillingOptions& options = {});

}  // namespace planar
