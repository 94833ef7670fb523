// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/key_slopes.h"

#include <algorithm>
#include <cmath>

namespace planar {

KeyGaps key_gaps(double before, double key, double after) {
  constexpr double least = 1e-100;  // what moves so much faster stands still for the other
  const double first = key - before, second = after - key;
  // A power of two, which rounds nothing.
  const int unit = std::ilogb(std::max(first, second));
  return {std::max(std::ldexp(first, -unit), least), std::max(std::ldexp(second, -unit), least)};
}

double slope_through_key(double a, double b, KeyGaps gaps) {
  if (!(a * b > 0.0)) return 0.0;
  const double w1 = gaps.before + 2.0 * gaps.after, w2 = 2.0 * gaps.before + gaps.after;
  return (w1 + w2) / (w1 / a + w2 / b);
}

std::complex<double> slope_through_key(std::complex<double> a, std::complex<double> b, KeyGaps gaps) {
  const double speed_a = std::abs(a), speed_b = std::abs(b);
  if (!(speed_a > 0.0 && speed_b > 0.0)) return 0.0;
  return 0.5 * slope_through_key(speed_a, speed_b, gaps) * (a / speed_a + b / speed_b);
}

}  // namespace planar
