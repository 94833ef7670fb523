// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

namespace planar {

/// Solves A x = b in place for a Hermitian positive definite tridiagonal A, in time proportional to its size.
///
/// \param diagonal n numbers; overwritten
///
/// \param below n-1 numbers: below[k] is A(k+1, k)
///
/// \param x n numbers: b, then the solution
void solve_tridiagonal(std::vector<double>& diagonal, const std::vector<std::complex<double>>& below,
                       std::vector<std::complex<double>>& x);

}  // namespace planar
