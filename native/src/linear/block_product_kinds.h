// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PLANAR_AVX2
#endif

/// What lower_product chooses from.
namespace planar {

void lower_product_any(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c);
#ifdef PLANAR_AVX2
/// For processors with AVX2 and FMA.
void lower_product_avx2(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c);
#endif

}  // namespace planar
