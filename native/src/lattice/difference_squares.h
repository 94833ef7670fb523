// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lattice/point_matrix.h"
#include "lattice/weight_rows.h"

namespace planar {

/// Two vertices, first < second.
struct WeightedPair {
  int first, second;
  double weight;
};

/// Adds Σ weight (W_first - W_second)ᵀ (W_first - W_second) to a matrix of one unknown a point, on which all
/// points of such a pair are coupled.
void add_difference_squares(const LatticeWeights& weights, std::vector<WeightedPair> pairs,
                            PointMatrix& matrix);

}  // namespace planar
