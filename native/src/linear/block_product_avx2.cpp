// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "linear/block_kinds.h"
#include "linear/block_product.h"

#ifdef PLANAR_AVX2
// From here on, after everything that other sources compile as well.
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#include "linear/block_product_tiles.h"

namespace planar {

void lower_product_avx2(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c) {
  using Vector = double __attribute__((vector_size(32)));
  multiply_tiles<Vector>(a, m, n, k, stride, c);
}

}  // namespace planar

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
