// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#if defined(__x86_64__) && defined(__GNUC__)
#define PLANAR_AVX2
#endif

/// What lower_product, factor_panel and the steps of block_solve.h choose from: the same for any processor,
/// and for those with AVX2 and FMA.
namespace planar {

struct FactorBlock;
struct FactorPanel;

void lower_product_any(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c);
bool factor_panel_any(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride);
void solve_forward_any(const FactorBlock& block, double* x, int columns);
void solve_backward_any(const FactorBlock& block, double* x, int columns);
void solve_gathered_forward_any(const FactorBlock& block, double* y);
void solve_gathered_backward_any(const FactorBlock& block, double* y);

#ifdef PLANAR_AVX2
void lower_product_avx2(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c);
bool factor_panel_avx2(const FactorPanel& panel, const double* earlier, std::ptrdiff_t earlier_stride);
void solve_forward_avx2(const FactorBlock& block, double* x, int columns);
void solve_backward_avx2(const FactorBlock& block, double* x, int columns);
void solve_gathered_forward_avx2(const FactorBlock& block, double* y);
void solve_gathered_backward_avx2(const FactorBlock& block, double* y);

/// Of the processor that runs this.
bool has_avx2();
#endif

}  // namespace planar
