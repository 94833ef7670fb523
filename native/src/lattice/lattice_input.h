// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/lattice.h"

/// Checks of a LatticeSolver's data; each throws std::invalid_argument.
namespace planar {

void require_model(const Coordinates& rest, const LatticeSolver::Elements& elements,
                   const LatticeWeights& weights, const Coordinates& lattice_rest);
void require_options(const LatticeOptions& options, LatticeMethodKind method, bool triangles_in_2d);
void require_handles(const LatticeHandles& handles, Eigen::Index n_vertices, Eigen::Index n_points);
void require_targets(const char* name, const Coordinates& targets, Eigen::Index rows, Eigen::Index columns);

/// Rows with ascending columns, each once, and no entries that are 0.
LatticeWeights in_order(const LatticeWeights& weights);

}  // namespace planar
