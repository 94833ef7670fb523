// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/edge_graph.h"
#include "planar/inbetween.h"

namespace planar {

/// Algorithms 2 (InbetweenMethod::paper) and 1 (global) of [AIAP], as corrected: [AIAP 8] is
/// c = (R(π/2)e)ᵀe' / (eᵀe), its printed denominator is 0. Forward and reverse sampling are added up. What
/// the paper leaves out, translation, is as in Inbetweens.
///
/// Exceptions as `inbetween`.
std::vector<Points> paper_inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                                    const EdgeGraph& graph, const InbetweenOptions& options);

/// The turn of each edge between two keys, brought into line breadth first from edge to edge
/// [AIAP, section 4.3].
Eigen::VectorXd breadth_first_turns(const EdgeGraph& graph, const Points& from, const Points& to);

}  // namespace planar
