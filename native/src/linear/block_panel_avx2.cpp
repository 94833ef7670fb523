// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstring>

#include "linear/block_kinds.h"
#include "linear/block_panel.h"

#ifdef PLANAR_AVX2
// From here on, after everything that other sources compile as well.
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#include "linear/block_panel_tiles.h"

namespace planar {

bool factor_panel_avx2(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride) {
  using Vector = double __attribute__((vector_size(32)));
  return eliminate_panel<Vector>(panel, earlier, earlier_stride);
}

}  // namespace planar

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
