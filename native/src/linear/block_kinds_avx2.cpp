// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/block_kinds.h"

#ifdef PLANAR_AVX2
#include <immintrin.h>

#include <cmath>
#include <cstddef>
#include <cstring>

#include "linear/block_panel.h"
#include "linear/block_product.h"
#include "linear/block_solve.h"

#define PLANAR_FMA
// From here on, after everything that other sources compile as well.
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#include "linear/block_panel_tiles.h"
#include "linear/block_product_tiles.h"
#include "linear/block_solve_tiles.h"

namespace planar {

namespace {

using Four = double __attribute__((vector_size(32)));

void for_wide_strips(double* x, int columns, const auto& solve) {
  using Pair = double __attribute__((vector_size(16)));
  for_strips<Four, Pair, double>(x, columns, columns, solve);
}

}  // namespace

void lower_product_avx2(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c) {
  multiply_tiles<Four>(a, m, n, k, stride, c);
}

bool factor_panel_avx2(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride) {
  return eliminate_panel<Four>(panel, earlier, earlier_stride);
}

void solve_forward_avx2(const FactorBlock& block, double* x, int columns) {
  for_wide_strips(x, columns, [&block](const auto& strip) { strip.forward(block); });
}

void solve_backward_avx2(const FactorBlock& block, double* x, int columns) {
  for_wide_strips(x, columns, [&block](const auto& strip) { strip.backward(block); });
}

void solve_gathered_forward_avx2(const FactorBlock& block, double* y) { Gathered<Four>::forward(block, y); }

void solve_gathered_backward_avx2(const FactorBlock& block, double* y) { Gathered<Four>::backward(block, y); }

}  // namespace planar

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
