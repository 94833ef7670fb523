// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "linear/block_kinds.h"
#include "linear/block_solve.h"

#ifdef PLANAR_AVX2
#include <immintrin.h>

#define PLANAR_FMA
// From here on, after everything that other sources compile as well.
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#include "linear/block_solve_tiles.h"

namespace planar {

namespace {

using Four = double __attribute__((vector_size(32)));

void for_wide_strips(double* x, int columns, const auto& solve) {
  using Pair = double __attribute__((vector_size(16)));
  for_strips<Four, Pair, double>(x, columns, columns, solve);
}

}  // namespace

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
