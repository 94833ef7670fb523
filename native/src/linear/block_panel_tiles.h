// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#include "linear/block_panel.h"

/// What factor_panel does, for the sources that compile it for one kind of processor each: everything here is
/// theirs alone, and calls nothing that they could share.
namespace planar {
namespace {

/// The diagonal block of a panel's factor, with inverse pivots.
struct Corner {
  double s0, s1, s2, s3;  // inverse
  double l10, l20, l21, l30, l31, l32;

  /// A row of the factor from one of the panel, or several.
  template <class Rows>
  void eliminate(Rows& x0, Rows& x1, Rows& x2, Rows& x3) const {
    x0 = x0 * s0;
    x1 = (x1 - x0 * l10) * s1;
    x2 = (x2 - x0 * l20 - x1 * l21) * s2;
    x3 = (x3 - x0 * l30 - x1 * l31 - x2 * l32) * s3;
  }
};

/// The difference of what is at two places.
template <class Vector>
Vector difference(const double* from, const double* off) {
  Vector a, b;
  std::memcpy(&a, from, sizeof a);
  std::memcpy(&b, off, sizeof b);
  return a - b;
}

/// With `Vector` a number or a vector of numbers.
template <class Vector>
bool eliminate_panel(const FactorPanel& panel, const double* earlier, std::ptrdiff_t next_earlier) {
  constexpr int lanes = sizeof(Vector) / sizeof(double), columns = 4;
  const std::ptrdiff_t next = panel.stride;
  double* a = panel.value;
  const auto left = [a, next, earlier, next_earlier](int i, int j) {
    return a[i + j * next] - earlier[i + j * next_earlier];
  };

  Corner c{};
  const double d0 = left(0, 0);
  if (!(d0 > 0.0)) return false;
  a[0] = std::sqrt(d0);
  c.s0 = 1.0 / a[0];
  c.l10 = a[1] = left(1, 0) * c.s0;
  c.l20 = a[2] = left(2, 0) * c.s0;
  c.l30 = a[3] = left(3, 0) * c.s0;
  const double d1 = left(1, 1) - c.l10 * c.l10;
  if (!(d1 > 0.0)) return false;
  a[next + 1] = std::sqrt(d1);
  c.s1 = 1.0 / a[next + 1];
  c.l21 = a[next + 2] = (left(2, 1) - c.l20 * c.l10) * c.s1;
  c.l31 = a[next + 3] = (left(3, 1) - c.l30 * c.l10) * c.s1;
  const double d2 = left(2, 2) - c.l20 * c.l20 - c.l21 * c.l21;
  if (!(d2 > 0.0)) return false;
  a[2 * next + 2] = std::sqrt(d2);
  c.s2 = 1.0 / a[2 * next + 2];
  c.l32 = a[2 * next + 3] = (left(3, 2) - c.l30 * c.l20 - c.l31 * c.l21) * c.s2;
  const double d3 = left(3, 3) - c.l30 * c.l30 - c.l31 * c.l31 - c.l32 * c.l32;
  if (!(d3 > 0.0)) return false;
  a[3 * next + 3] = std::sqrt(d3);
  c.s3 = 1.0 / a[3 * next + 3];

  int row = columns;
  for (; row + lanes <= panel.height; row += lanes) {
    double* x = a + row;
    const double* e = earlier + row;
    Vector x0 = difference<Vector>(x, e);
    Vector x1 = difference<Vector>(x + next, e + next_earlier);
    Vector x2 = difference<Vector>(x + 2 * next, e + 2 * next_earlier);
    Vector x3 = difference<Vector>(x + 3 * next, e + 3 * next_earlier);
    c.eliminate(x0, x1, x2, x3);
    std::memcpy(x, &x0, sizeof x0);
    std::memcpy(x + next, &x1, sizeof x1);
    std::memcpy(x + 2 * next, &x2, sizeof x2);
    std::memcpy(x + 3 * next, &x3, sizeof x3);
  }
  for (; row < panel.height; ++row) {
    double x0 = left(row, 0), x1 = left(row, 1), x2 = left(row, 2), x3 = left(row, 3);
    c.eliminate(x0, x1, x2, x3);
    a[row] = x0;
    a[row + next] = x1;
    a[row + 2 * next] = x2;
    a[row + 3 * next] = x3;
  }
  return true;
}

}  // namespace
}  // namespace planar
