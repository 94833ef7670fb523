// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "mesh/edge_graph.h"
#include "parallel/thread_team.h"

namespace planar {

/// Takes the frames of a transition (n×2, at these u) nearer to the keys' blended triangles, which know areas
/// and angles where edges know lengths only: by projected Newton steps of the rest energy of those triangles,
/// of the same length for all frames, so that they stay alike. Parts that are not PartCondition::sound stay
/// as they are; a step that cannot be solved for, or would not lessen the energy of each frame, is not taken.
///
/// \param progress called with the share of the work done; may throw
void relax_frames(const EdgeGraph& graph, const Points& from, const Points& to, const Eigen::VectorXd& u,
                  std::vector<Points>& frames, const std::function<void(double)>& progress, ThreadTeam& team);

}  // namespace planar
