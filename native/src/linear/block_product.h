// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace planar {

/// Rows and columns of the tiles that products are made of.
constexpr int tile_rows = 8, tile_columns = 4;
/// Numbers that must be readable behind the last one of a factor: tiles at its edges read on.
constexpr std::size_t tile_overhang = 16;

/// From column to column of a product with m rows: tiles at its edges write whole.
inline std::ptrdiff_t product_stride(int m) { return (m + tile_rows - 1) / tile_rows * tile_rows; }

/// C ← A Bᵀ, lower part (i ≥ j), with m×k A and B its first n rows, by columns.
///
/// \param stride from column to column of A
///
/// \param c product_stride(m) times n rounded up to tile_columns; the numbers above the diagonal and behind
/// row m or column n are arbitrary
void lower_product(const double* a, int m, int n, int k, std::ptrdiff_t stride, double* c);

}  // namespace planar
