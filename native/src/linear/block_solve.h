// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace planar {

/// Some columns of a Cholesky factor with the same rows, as a dense block.
struct FactorBlock {
  const double* value;  ///< height×width by columns; its upper triangle is arbitrary
  int width, height;
  const int* row;  ///< of the factor: those of the block's own columns, one after another, then those below
};

/// A block's step of x ← L⁻¹ x, all of those before it done: its own rows of x are solved for and taken out
/// of those below. What a column of x becomes depends on no other column nor on how many there are.
///
/// \param x a row an unknown, `columns` numbers each
void solve_forward(const FactorBlock& block, double* x, int columns);

/// A block's step of x ← L⁻ᵀ x, all of those behind it done.
void solve_backward(const FactorBlock& block, double* x, int columns);

/// The same steps for one right side, of which y has what is at the block's rows, next to each other.
void solve_gathered_forward(const FactorBlock& block, double* y);
void solve_gathered_backward(const FactorBlock& block, double* y);

}  // namespace planar
