// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>

namespace planar {

/// The operator's care for infinities costs a call.
inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// For code that is the same for both.
inline double product(double a, double b) { return a * b; }

}  // namespace planar
