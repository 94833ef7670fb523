// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstring>

#include "linear/block_solve.h"

/// What the steps of block_solve.h do, for the sources that compile it for one kind of processor each:
/// everything here is theirs alone, and calls nothing that they could share.
namespace planar {
namespace {

/// a - x factor, rounded once where the processor can, whatever the compiler would contract by itself: a
/// right side's solution must not depend on the ones beside it, which say how wide a vector it is in. The
/// source that includes this tells by PLANAR_FMA: Clang's __FMA__ is that of the whole source.
template <class Vector>
Vector minus_product(const Vector& a, const Vector& x, double factor) {
#ifdef PLANAR_FMA
  if constexpr (sizeof(Vector) == 32) {
    return _mm256_fnmadd_pd(x, _mm256_set1_pd(factor), a);
  } else if constexpr (sizeof(Vector) == 16) {
    return _mm_fnmadd_pd(x, _mm_set1_pd(factor), a);
  } else {
    return __builtin_fma(-x, factor, a);
  }
#else
  return a - x * factor;
#endif
}

/// Vectors of right sides next to each other, one or two: arrays of them would live in memory.
template <class Vector, bool two>
struct Wide {
  static constexpr std::size_t number = sizeof(double);
  static constexpr int lanes = sizeof(Vector) / number;

  explicit Wide(const double* from) {
    std::memcpy(&first, from, sizeof first);
    if constexpr (two) std::memcpy(&second, from + lanes, sizeof second);
  }
  void store(double* to) const {
    std::memcpy(to, &first, sizeof first);
    if constexpr (two) std::memcpy(to + lanes, &second, sizeof second);
  }
  void subtract(const Wide& x, double factor) {
    first = minus_product(first, x.first, factor);
    if constexpr (two) second = minus_product(second, x.second, factor);
  }
  void scale(double factor) {
    first *= factor;
    if constexpr (two) second *= factor;
  }

  Vector first, second{};
};

/// Columns of x of the width of a Wide.
template <class Columns>
struct Strip {
  /// Rows of the factor that are worked on together: with two vectors of right sides their sums fill half of
  /// the registers.
  static constexpr int rows_at_once = 4;

  double* x;
  std::ptrdiff_t stride;

  double* at(int row) const { return x + row * stride; }

  /// x[to[r]] ← x[to[r]] - Σ_p a[r·next_row + p·next] x[from[p]] for rows_at_once rows r, then
  /// finish(x[to[0]], ...) before they leave the registers.
  void subtract_four(const double* a, std::ptrdiff_t next_row, std::ptrdiff_t next, const int* from,
                     int count, const int* to, const auto& finish) const {
    static_assert(rows_at_once == 4);
    Columns x0(at(to[0])), x1(at(to[1])), x2(at(to[2])), x3(at(to[3]));
    for (int p = 0; p < count; ++p, a += next) {
      const Columns known(at(from[p]));
      x0.subtract(known, a[0]);
      x1.subtract(known, a[next_row]);
      x2.subtract(known, a[2 * next_row]);
      x3.subtract(known, a[3 * next_row]);
    }
    finish(x0, x1, x2, x3);
    x0.store(at(to[0]));
    x1.store(at(to[1]));
    x2.store(at(to[2]));
    x3.store(at(to[3]));
  }

  /// The same for one row.
  void subtract_one(const double* a, std::ptrdiff_t next, const int* from, int count, int to,
                    const auto& finish) const {
    Columns own(at(to));
    for (int p = 0; p < count; ++p, a += next) own.subtract(Columns(at(from[p])), *a);
    finish(own);
    own.store(at(to));
  }

  void forward(const FactorBlock& b) const {
    const std::ptrdiff_t next = b.height;
    int row = 0;
    for (; row + rows_at_once <= b.width; row += rows_at_once) {
      const double* d = b.value + row * (next + 1);  // on the diagonal
      const auto solve = [d, next](Columns& x0, Columns& x1, Columns& x2, Columns& x3) {
        x0.scale(1.0 / d[0]);
        x1.subtract(x0, d[1]);
        x2.subtract(x0, d[2]);
        x3.subtract(x0, d[3]);
        x1.scale(1.0 / d[next + 1]);
        x2.subtract(x1, d[next + 2]);
        x3.subtract(x1, d[next + 3]);
        x2.scale(1.0 / d[2 * next + 2]);
        x3.subtract(x2, d[2 * next + 3]);
        x3.scale(1.0 / d[3 * next + 3]);
      };
      subtract_four(b.value + row, 1, next, b.row, row, b.row + row, solve);
    }
    for (; row < b.width; ++row) {
      const double pivot = b.value[row * (next + 1)];
      subtract_one(b.value + row, next, b.row, row, b.row[row],
                   [pivot](Columns& own) { own.scale(1.0 / pivot); });
    }
    for (; row + rows_at_once <= b.height; row += rows_at_once) {
      subtract_four(b.value + row, 1, next, b.row, b.width, b.row + row,
                    [](Columns&, Columns&, Columns&, Columns&) {});
    }
    for (; row < b.height; ++row) {
      subtract_one(b.value + row, next, b.row, b.width, b.row[row], [](Columns&) {});
    }
  }

  void backward(const FactorBlock& b) const {
    const std::ptrdiff_t next = b.height;
    int end = b.width;
    for (; end % rows_at_once != 0; --end) {
      const double* d = b.value + (end - 1) * (next + 1);
      subtract_one(d + 1, 1, b.row + end, b.height - end, b.row[end - 1],
                   [d](Columns& own) { own.scale(1.0 / *d); });
    }
    for (; end > 0; end -= rows_at_once) {
      const int first = end - rows_at_once;
      const double* d = b.value + first * (next + 1);
      const auto solve = [d, next](Columns& x0, Columns& x1, Columns& x2, Columns& x3) {
        x3.scale(1.0 / d[3 * next + 3]);
        x2.subtract(x3, d[2 * next + 3]);
        x1.subtract(x3, d[next + 3]);
        x0.subtract(x3, d[3]);
        x2.scale(1.0 / d[2 * next + 2]);
        x1.subtract(x2, d[next + 2]);
        x0.subtract(x2, d[2]);
        x1.scale(1.0 / d[next + 1]);
        x0.subtract(x1, d[1]);
        x0.scale(1.0 / d[0]);
      };
      subtract_four(b.value + first * next + end, next, 1, b.row + end, b.height - end, b.row + first, solve);
    }
  }
};

/// Calls solve(strip) for strips of two vectors, then of one, then of narrower ones.
template <class Vector, class... Narrower>
void for_strips(double* x, std::ptrdiff_t stride, int columns, const auto& solve) {
  constexpr int lanes = Wide<Vector, false>::lanes;
  for (; columns >= 2 * lanes; columns -= 2 * lanes, x += 2 * lanes)
    solve(Strip<Wide<Vector, true>>{x, stride});
  if (columns >= lanes) {
    solve(Strip<Wide<Vector, false>>{x, stride});
    columns -= lanes;
    x += lanes;
  }
  if constexpr (sizeof...(Narrower) > 0) for_strips<Narrower...>(x, stride, columns, solve);
}

/// One right side, with vectors of its rows. The factor is read once, which takes most of the time, so four
/// of its columns share what is read of the right side.
template <class Vector>
struct Gathered {
  static constexpr int lanes = sizeof(Vector) / sizeof(double), columns_at_once = 4;

  static Vector load(const double* from) {
    Vector result;
    std::memcpy(&result, from, sizeof result);
    return result;
  }

  static double sum(const Vector& v) {
    if constexpr (lanes == 1) {
      return v;
    } else {
      double result = 0.0;
      for (int lane = 0; lane < lanes; ++lane) result += v[lane];
      return result;
    }
  }

  static void forward(const FactorBlock& b, double* y) {
    const std::ptrdiff_t next = b.height;
    int first = 0;
    for (; first + columns_at_once <= b.width; first += columns_at_once) {
      const double* d = b.value + first * (next + 1);  // on the diagonal
      const double y0 = y[first] / d[0];
      const double y1 = (y[first + 1] - d[1] * y0) / d[next + 1];
      const double y2 = (y[first + 2] - d[2] * y0 - d[next + 2] * y1) / d[2 * next + 2];
      const double y3 =
          (y[first + 3] - d[3] * y0 - d[next + 3] * y1 - d[2 * next + 3] * y2) / d[3 * next + 3];
      y[first] = y0;
      y[first + 1] = y1;
      y[first + 2] = y2;
      y[first + 3] = y3;
      const double* c = b.value + first * next;
      int row = first + columns_at_once;
      for (; row + lanes <= b.height; row += lanes) {
        const Vector left = load(y + row) - load(c + row) * y0 - load(c + next + row) * y1 -
                            load(c + 2 * next + row) * y2 - load(c + 3 * next + row) * y3;
        std::memcpy(y + row, &left, sizeof left);
      }
      for (; row < b.height; ++row) {
        y[row] -= c[row] * y0 + c[next + row] * y1 + c[2 * next + row] * y2 + c[3 * next + row] * y3;
      }
    }
    for (; first < b.width; ++first) {
      const double* c = b.value + first * next;
      const double known = y[first] /= c[first];
      for (int row = first + 1; row < b.height; ++row) y[row] -= c[row] * known;
    }
  }

  static void backward(const FactorBlock& b, double* y) {
    const std::ptrdiff_t next = b.height;
    int end = b.width;
    for (; end % columns_at_once != 0; --end) {
      const double* c = b.value + (end - 1) * next;
      double known = 0.0;
      for (int row = end; row < b.height; ++row) known += c[row] * y[row];
      y[end - 1] = (y[end - 1] - known) / c[end - 1];
    }
    for (; end > 0; end -= columns_at_once) {
      const int first = end - columns_at_once;
      const double* c = b.value + first * next;
      Vector s0{}, s1{}, s2{}, s3{};
      int row = end;
      for (; row + lanes <= b.height; row += lanes) {
        const Vector known = load(y + row);
        s0 += load(c + row) * known;
        s1 += load(c + next + row) * known;
        s2 += load(c + 2 * next + row) * known;
        s3 += load(c + 3 * next + row) * known;
      }
      double known0 = sum(s0), known1 = sum(s1), known2 = sum(s2), known3 = sum(s3);
      for (; row < b.height; ++row) {
        known0 += c[row] * y[row];
        known1 += c[next + row] * y[row];
        known2 += c[2 * next + row] * y[row];
        known3 += c[3 * next + row] * y[row];
      }
      const double* d = c + first;  // on the diagonal
      const double y3 = (y[first + 3] - known3) / d[3 * next + 3];
      const double y2 = (y[first + 2] - known2 - d[2 * next + 3] * y3) / d[2 * next + 2];
      const double y1 = (y[first + 1] - known1 - d[next + 2] * y2 - d[next + 3] * y3) / d[next + 1];
      y[first] = (y[first] - known0 - d[1] * y1 - d[2] * y2 - d[3] * y3) / d[0];
      y[first + 1] = y1;
      y[first + 2] = y2;
      y[first + 3] = y3;
    }
  }
};

}  // namespace
}  // namespace planar
