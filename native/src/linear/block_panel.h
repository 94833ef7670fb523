// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace planar {

/// Four columns of a Cholesky factor from their diagonal down, to be eliminated.
struct FactorPanel {
  double* value;  ///< by columns; above the diagonal arbitrary, and so it stays
  std::ptrdiff_t stride;
  int height;  ///< at least 4
};

/// Takes `earlier` (by columns as well) off a panel, what the columns before it have in it, and eliminates it
/// [L_ij of Cholesky's A = LLᵀ]. False if a pivot is not positive; the panel is lost then.
bool factor_panel(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride);

}  // namespace planar
