// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/edge_equations.h"

#include <algorithm>
#include <vector>

#include "base/complex_product.h"
#include "linear/tridiagonal.h"

namespace planar {

using Complex = std::complex<double>;

namespace {

/// Δt c of [AIAP 8] at the first and at the second frame of a pair: by the forward and by the backward
/// difference.
struct Rates {
  Rates(Complex first, Complex second) {
    const double area = product(std::conj(first), second).imag();
    if (std::norm(first) > 0.0) forward = area / std::norm(first);
    if (std::norm(second) > 0.0) reverse = area / std::norm(second);
  }
  double forward = 0.0, reverse = 0.0;
};

}  // namespace

void edge_equations(const Eigen::Ref<const EdgeRow>& e, double* diagonal, Complex* below, Complex* right) {
  const Eigen::Index last = e.size() - 1, n = last - 1;
  std::fill_n(diagonal, n, 2.0);
  std::fill_n(below, n, Complex(0.0));
  std::fill_n(right, n, Complex(0.0));
  for (Eigen::Index k = 0; k < last; ++k) {
    const Rates rates(e[k], e[k + 1]);
    const Complex coupling(-2.0, -rates.forward - rates.reverse);
    if (k > 0) diagonal[k - 1] += 1.0 + rates.forward * rates.forward;
    if (k + 1 < last) diagonal[k] += 1.0 + rates.reverse * rates.reverse;
    if (k == 0) right[0] -= product(coupling, e[0]);
    if (k + 1 == last) right[n - 1] -= product(std::conj(coupling), e[last]);
    if (k > 0 && k + 1 < last) below[k - 1] = coupling;
  }
}

void minimise_edge_energy(Eigen::Ref<EdgeRow> e) {
  const Eigen::Index last = e.size() - 1;
  if (last < 2) return;
  const auto n = static_cast<std::size_t>(last - 1);
  std::vector<double> diagonal(n);
  std::vector<Complex> below(n), x(n);
  edge_equations(e, diagonal.data(), below.data(), x.data());
  solve_tridiagonal(diagonal, below, x);
  std::copy(x.begin(), x.end(), &e[1]);
}

}  // namespace planar
