// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "mesh/edge_graph.h"
#include "parallel/thread_team.h"

namespace planar {

/// How the triangles of a part fare between two keys.
enum class PartCondition {
  sound,     ///< none is flipped or about to collapse
  failing,   ///< some are, though they lie the same way round in both keys
  hopeless,  ///< some lie the other way round in one key than in the other
};

/// The condition of each part in these frames, which are at u.
std::vector<PartCondition> conditions_of_parts(const EdgeGraph& graph, const Points& from, const Points& to,
                                               const std::vector<Points>& frames, const Eigen::VectorXd& u,
                                               ThreadTeam& team);

/// The triangles of the parts in a condition.
Triangles triangles_of_parts(const EdgeGraph& graph, const std::vector<PartCondition>& conditions,
                             PartCondition wanted);

}  // namespace planar
