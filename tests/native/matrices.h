// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <numeric>
#include <vector>

#include "linear/sparse_solver.h"

namespace planar::testing {

/// All vertices, in their order.
inline std::vector<int> all(int n) {
  std::vector<int> kept(static_cast<std::size_t>(n));
  std::iota(kept.begin(), kept.end(), 0);
  return kept;
}

/// The whole of a symmetric matrix.
inline Eigen::MatrixXd dense(const SymmetricMatrix& lower) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(lower.size, lower.size);
  for (int j = 0; j < lower.size; ++j) {
    for (int p = lower.column_start[static_cast<std::size_t>(j)];
         p < lower.column_start[static_cast<std::size_t>(j) + 1]; ++p) {
      const int i = lower.row[static_cast<std::size_t>(p)];
      result(i, j) = result(j, i) = lower.value[static_cast<std::size_t>(p)];
    }
  }
  return result;
}

}  // namespace planar::testing
