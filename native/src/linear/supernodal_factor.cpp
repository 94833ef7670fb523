// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/supernodal_factor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include "base/complex_product.h"
#include "base/index.h"
#include "linear/block_panel.h"
#include "linear/block_product.h"

namespace planar {

namespace {

template <class Number>
constexpr int doubles = std::same_as<Number, double> ? 1 : 2;  // that a number is made of

using Complex = std::complex<double>;

/// Of conj(a) and b.
Complex dot(const Complex* a, const Complex* b, int count) {
  const auto* x = reinterpret_cast<const double*>(a);
  const auto* y = reinterpret_cast<const double*>(b);
  // A term's parts are x0 y0 + x1 y1 and x0 y1 - x1 y0.
  std::array<double, 4> straight{}, crossed{};
  int i = 0;
  for (; i + 2 <= count; i += 2, x += 4, y += 4) {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      straight[lane] += x[lane] * y[lane];
      crossed[lane] += x[lane] * y[lane ^ 1];
    }
  }
  const Complex rest = i < count ? product(std::conj(a[i]), b[i]) : 0.0;
  return Complex((straight[0] + straight[1]) + (straight[2] + straight[3]),
                 (crossed[0] - crossed[1]) + (crossed[2] - crossed[3])) +
         rest;
}

/// What block_solve.h does, for complex numbers, of which few systems are made.
void solve_gathered_forward(const Complex* column, int width, int height, Complex* y) {
  for (int j = 0; j < width; ++j, column += height) {
    y[j] /= column[j].real();
    for (int i = j + 1; i < height; ++i) y[i] -= product(column[i], y[j]);
  }
}

void solve_gathered_backward(const Complex* value, int width, int height, Complex* y) {
  for (int j = width - 1; j >= 0; --j) {
    const Complex* column = value + static_cast<std::ptrdiff_t>(j) * height;
    y[j] = (y[j] - dot(column + j + 1, y + j + 1, height - j - 1)) / column[j].real();
  }
}

void solve_gathered_forward(const double* value, int width, int height, double* y) {
  solve_gathered_forward(FactorBlock{value, width, height, nullptr}, y);
}

void solve_gathered_backward(const double* value, int width, int height, double* y) {
  solve_gathered_backward(FactorBlock{value, width, height, nullptr}, y);
}

/// The lower part of A Bᴴ, with m×k A and B its first n rows. With complex numbers as rows of doubles,
/// lower_product makes all products of their parts, half as many as for the real matrices of twice the size.
template <class Number>
class LowerProduct {
 public:
  LowerProduct(const Number* a, int m, int n, int k, std::ptrdiff_t stride, double* room)
      : value_(room), stride_(product_stride(parts * m)) {
    lower_product(reinterpret_cast<const double*>(a), parts * m, parts * n, k, parts * stride, room);
  }

  /// i ≥ j; of the diagonal the real part alone.
  Number operator()(int i, int j) const {
    const double* place = value_ + parts * (i + j * stride_);
    if constexpr (parts == 1) {
      return *place;
    } else {
      return {place[0] + place[stride_ + 1], place[1] - place[stride_]};
    }
  }

 private:
  static constexpr int parts = doubles<Number>;

  const double* value_;
  std::ptrdiff_t stride_;
};

}  // namespace

template <class Number>
SupernodalFactor<Number>::SupernodalFactor(Supernodes supernodes) : nodes_(std::move(supernodes)) {
  const int count = static_cast<int>(nodes_.first.size()) - 1;
  std::size_t total = 0;
  int widest = 0, highest = 0;
  for (int s = 0; s < count; ++s) {
    start_.push_back(total);
    total += at(width(s)) * at(height(s));
    widest = std::max(widest, width(s));
    highest = std::max(highest, height(s));
    owner_.insert(owner_.end(), at(width(s)), s);
  }
  value_.assign(total + tile_overhang, 0.0);
  constexpr int parts = doubles<Number>;
  work_.assign(
      static_cast<std::size_t>(product_stride(parts * highest)) * at(parts * (widest + tile_columns)), 0.0);
  rows_of_x_.resize(highest);
  place_.resize(owner_.size());
  relative_.resize(at(highest));
  waiting_.resize(start_.size());
  next_waiting_.resize(start_.size());
  passed_.resize(start_.size());
}

template <class Number>
bool SupernodalFactor<Number>::factorize(const SelfAdjointMatrix<Number>& matrix) {
  std::fill(waiting_.begin(), waiting_.end(), -1);
  for (int s = 0; s < n_blocks(); ++s) {
    gather(s, matrix);
    for (int from = waiting_[at(s)], following; from >= 0; from = following) {
      following = next_waiting_[at(from)];
      subtract(from, s);
      queue(from);
    }
    if (!factor_block(s)) return false;
    passed_[at(s)] = width(s);
    queue(s);
  }
  return true;
}

/// Puts a finished block to those that change the block of its next row.
template <class Number>
void SupernodalFactor<Number>::queue(int s) {
  if (passed_[at(s)] == height(s)) return;
  const int later = owner_[at(rows(s)[passed_[at(s)]])];
  next_waiting_[at(s)] = std::exchange(waiting_[at(later)], s);
}

/// Fills block s with the matrix, and place_ for it.
template <class Number>
void SupernodalFactor<Number>::gather(int s, const SelfAdjointMatrix<Number>& matrix) {
  for (int i = 0; i < height(s); ++i) place_[at(rows(s)[i])] = i;
  Number* column = block(s);
  std::fill_n(column, at(height(s)) * at(width(s)), 0.0);
  for (int j = nodes_.first[at(s)]; j < nodes_.first[at(s) + 1]; ++j, column += height(s)) {
    for (int p = matrix.column_start[at(j)]; p < matrix.column_start[at(j) + 1]; ++p) {
      column[place_[at(matrix.row[at(p)])]] = matrix.value[at(p)];
    }
  }
}

/// Subtracts from block s what a finished block has in its columns, and passes these rows.
template <class Number>
void SupernodalFactor<Number>::subtract(int from, int s) {
  const int passed = passed_[at(from)], left = height(from) - passed;
  const int* row = rows(from) + passed;
  const int columns = static_cast<int>(std::lower_bound(row, row + left, nodes_.first[at(s) + 1]) - row);
  const LowerProduct<Number> product(block(from) + passed, left, columns, width(from), height(from),
                                     work_.data());
  for (int i = 0; i < left; ++i) relative_[at(i)] = place_[at(row[i])];
  for (int j = 0; j < columns; ++j) {
    Number* column = block(s) + static_cast<std::ptrdiff_t>(relative_[at(j)]) * height(s);
    for (int i = j; i < left; ++i) column[relative_[at(i)]] -= product(i, j);
  }
  passed_[at(from)] += columns;
}

/// Dense Cholesky of a block, a few columns at a time; false if it is not positive definite.
template <class Number>
bool SupernodalFactor<Number>::factor_block(int s) {
  const std::ptrdiff_t stride = height(s);
  for (int first = 0; first < width(s); first += tile_columns) {
    const int count = std::min(tile_columns, width(s) - first), left = height(s) - first;
    Number* panel = block(s) + first * (stride + 1);
    const LowerProduct<Number> earlier_columns(block(s) + first, left, count, first, stride, work_.data());
    if constexpr (std::same_as<Number, double>) {
      if (count == tile_columns) {
        if (!factor_panel({panel, stride, left}, work_.data(), product_stride(left))) return false;
        continue;
      }
    }
    for (int j = 0; j < count; ++j) {
      Number* column = panel + j * stride;
      for (int i = j; i < left; ++i) column[i] -= earlier_columns(i, j);
      for (int e = 0; e < j; ++e) {
        const Number* earlier = panel + e * stride;
        const Number factor = Eigen::numext::conj(earlier[j]);
        for (int i = j; i < left; ++i) column[i] -= product(factor, earlier[i]);
      }
      const double pivot = std::real(column[j]);
      if (!(pivot > 0.0)) return false;
      const double scale = 1.0 / std::sqrt(pivot);
      column[j] = pivot;
      for (int i = j; i < left; ++i) column[i] *= scale;
    }
  }
  return true;
}

template <class Number>
void SupernodalFactor<Number>::solve(Vector& x) {
  Number* y = rows_of_x_.data();
  const auto gather_rows = [this, &x, y](int s) {
    for (int i = 0; i < height(s); ++i) y[i] = x[rows(s)[i]];
  };
  for (int s = 0; s < n_blocks(); ++s) {
    const Number* own = x.data() + nodes_.first[at(s)];
    if (std::all_of(own, own + width(s), [](Number value) { return value == 0.0; })) continue;
    gather_rows(s);
    solve_gathered_forward(block(s), width(s), height(s), y);
    for (int i = 0; i < height(s); ++i) x[rows(s)[i]] = y[i];
  }
  for (int s = n_blocks() - 1; s >= 0; --s) {
    gather_rows(s);
    solve_gathered_backward(block(s), width(s), height(s), y);
    std::copy_n(y, width(s), x.data() + nodes_.first[at(s)]);
  }
}

template class SupernodalFactor<double>;
template class SupernodalFactor<Complex>;

}  // namespace planar
