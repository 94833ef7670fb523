// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/tridiagonal.h"

#include "base/complex_product.h"

namespace planar {

void solve_tridiagonal(std::vector<double>& diagonal, const std::vector<std::complex<double>>& below,
                       std::vector<std::complex<double>>& x) {
  // LDLᴴ without pivoting, which is stable for positive definite matrices.
  const std::size_t n = x.size();
  for (std::size_t k = 0; k + 1 < n; ++k) {
    diagonal[k + 1] -= std::norm(below[k]) / diagonal[k];
    x[k + 1] -= product(below[k], x[k]) / diagonal[k];
  }
  for (std::size_t k = n; k-- > 0;) {
    if (k + 1 < n) x[k] -= product(std::conj(below[k]), x[k + 1]);
    x[k] /= diagonal[k];
  }
}

}  // namespace planar
