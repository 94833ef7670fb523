// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/block_product.h"

#include "linear/block_kinds.h"
#include "linear/block_product_tiles.h"

namespace planar {

void lower_product_any(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c) {
#ifdef __GNUC__
  using Vector = double __attribute__((vector_size(16)));
  multiply_tiles<Vector>(a, m, n, k, stride, c);
#else
  multiply_tiles<double>(a, m, n, k, stride, c);
#endif
}

namespace {

auto of_this_processor() {
#ifdef PLANAR_AVX2
  if (has_avx2()) return lower_product_avx2;
#endif
  return lower_product_any;
}

}  // namespace

void lower_product(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c) {
  static const auto chosen = of_this_processor();
  chosen(a, m, n, k, stride, c);
}

}  // namespace planar
