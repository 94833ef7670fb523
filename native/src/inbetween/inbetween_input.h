// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/edge_graph.h"
#include "planar/inbetween.h"

namespace planar {

/// Checks of keys and options, and what follows from them, shared by all methods.

void require_keys(const std::vector<Points>& keys);

/// options.key_times, or 0..K-1.
Eigen::VectorXd key_times_of(const std::vector<Points>& keys, const InbetweenOptions& options);

void require_iteration(const InbetweenOptions& options);

/// The shapes that lengths are taken from: options.rest, or the keys.
std::vector<Points> references_of(const std::vector<Points>& keys, const InbetweenOptions& options);

/// The diagonal of a square that holds each of some shapes however it is turned: √2 times the largest
/// diameter.
double size_of(const std::vector<Points>& shapes);

/// 1/|e| of [AIAP 10], an edge's lengths in some shapes averaged, and held to a ten-thousandth of the mean
/// edge.
Eigen::VectorXd frozen_weights(const EdgeGraph& graph, const std::vector<Points>& shapes);

/// options.turns as (K-1)×parts.
Eigen::MatrixXi turns_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                         const InbetweenOptions& options);

/// options.anchors, a set for each transition.
std::vector<Eigen::VectorXi> anchors_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                                        const InbetweenOptions& options);

/// options.joints, a set for each transition, checked.
std::vector<Edges> joints_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                             const InbetweenOptions& options);

/// The mean of `turns` (one an edge) over the edges of each part, by their lengths in both keys.
Eigen::VectorXd mean_turns(const EdgeGraph& graph, const Eigen::VectorXd& turns, const Points& from,
                           const Points& to);

}  // namespace planar
