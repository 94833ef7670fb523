// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/block_panel.h"

#include "linear/block_kinds.h"
#include "linear/block_panel_tiles.h"

namespace planar {

bool factor_panel_any(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride) {
#ifdef __GNUC__
  using Vector = double __attribute__((vector_size(16)));
  return eliminate_panel<Vector>(panel, earlier, earlier_stride);
#else
  return eliminate_panel<double>(panel, earlier, earlier_stride);
#endif
}

namespace {

auto of_this_processor() {
#ifdef PLANAR_AVX2
  if (has_avx2()) return factor_panel_avx2;
#endif
  return factor_panel_any;
}

}  // namespace

bool factor_panel(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride) {
  static const auto chosen = of_this_processor();
  return chosen(panel, earlier, earlier_stride);
}

}  // namespace planar
