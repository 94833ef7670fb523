// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>

#include "linear/block_product.h"

/// What lower_product does, for the sources that compile it for one kind of processor each: everything here
/// is theirs alone, and calls nothing that they could share.
namespace planar {
namespace {

/// With `Vector` a number or a vector of numbers. A tile is two vectors high.
template <class Vector>
void multiply_tiles(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c) {
  constexpr int lanes = sizeof(Vector) / sizeof(double), rows = 2 * lanes;
  static_assert(tile_rows % rows == 0 && tile_overhang >= rows + tile_columns);
  const std::ptrdiff_t stride_c = product_stride(m);
  for (int j = 0; j < n; j += tile_columns) {
    for (int i = j / rows * rows; i < m; i += rows) {
      const double* left = a + i;
      const double* right = a + j;
      // Sixteen or fewer registers; arrays of sums would live in memory.
      Vector s00{}, s01{}, s10{}, s11{}, s20{}, s21{}, s30{}, s31{};
      for (int p = 0; p < k; ++p, left += stride, right += stride) {
        Vector x0, x1;
        std::memcpy(&x0, left, sizeof x0);
        std::memcpy(&x1, left + lanes, sizeof x1);
        s00 += x0 * right[0];
        s01 += x1 * right[0];
        s10 += x0 * right[1];
        s11 += x1 * right[1];
        s20 += x0 * right[2];
        s21 += x1 * right[2];
        s30 += x0 * right[3];
        s31 += x1 * right[3];
      }
      double* to = c + i + j * stride_c;
      std::memcpy(to, &s00, sizeof s00);
      std::memcpy(to + lanes, &s01, sizeof s01);
      to += stride_c;
      std::memcpy(to, &s10, sizeof s10);
      std::memcpy(to + lanes, &s11, sizeof s11);
      to += stride_c;
      std::memcpy(to, &s20, sizeof s20);
      std::memcpy(to + lanes, &s21, sizeof s21);
      to += stride_c;
      std::memcpy(to, &s30, sizeof s30);
      std::memcpy(to + lanes, &s31, sizeof s31);
    }
  }
}

}  // namespace
}  // namespace planar
