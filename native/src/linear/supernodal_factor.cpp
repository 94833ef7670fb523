// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/supernodal_factor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/index.h"
#include "linear/block_product.h"

namespace planar {

namespace {

/// In eight sums: one would wait for each addition.
double dot(const double* a, const double* b, int count) {
  std::array<double, 8> sum{};
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    for (int lane = 0; lane < 8; ++lane) sum[static_cast<std::size_t>(lane)] += a[i + lane] * b[i + lane];
  }
  double rest = 0.0;
  for (; i < count; ++i) rest += a[i] * b[i];
  return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7])) + rest;
}

}  // namespace

SupernodalFactor::SupernodalFactor(Supernodes supernodes) : nodes_(std::move(supernodes)) {
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
  work_.assign(static_cast<std::size_t>(product_stride(highest)) * at(widest + tile_columns), 0.0);
  place_.resize(owner_.size());
  relative_.resize(at(highest));
  waiting_.resize(start_.size());
  next_waiting_.resize(start_.size());
  passed_.resize(start_.size());
}

bool SupernodalFactor::factorize(const SymmetricMatrix& matrix) {
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
void SupernodalFactor::queue(int s) {
  if (passed_[at(s)] == height(s)) return;
  const int later = owner_[at(rows(s)[passed_[at(s)]])];
  next_waiting_[at(s)] = std::exchange(waiting_[at(later)], s);
}

/// Fills block s with the matrix, and place_ for it.
void SupernodalFactor::gather(int s, const SymmetricMatrix& matrix) {
  for (int i = 0; i < height(s); ++i) place_[at(rows(s)[i])] = i;
  double* column = block(s);
  std::fill_n(column, at(height(s)) * at(width(s)), 0.0);
  for (int j = nodes_.first[at(s)]; j < nodes_.first[at(s) + 1]; ++j, column += height(s)) {
    for (int p = matrix.column_start[at(j)]; p < matrix.column_start[at(j) + 1]; ++p) {
      column[place_[at(matrix.row[at(p)])]] = matrix.value[at(p)];
    }
  }
}

/// Subtracts from block s what a finished block has in its columns, and passes these rows.
void SupernodalFactor::subtract(int from, int s) {
  const int passed = passed_[at(from)], left = height(from) - passed;
  const int* row = rows(from) + passed;
  const int columns = static_cast<int>(std::lower_bound(row, row + left, nodes_.first[at(s) + 1]) - row);
  lower_product(block(from) + passed, left, columns, width(from), height(from), work_.data());
  for (int i = 0; i < left; ++i) relative_[at(i)] = place_[at(row[i])];
  const double* product = work_.data();
  for (int j = 0; j < columns; ++j, product += product_stride(left)) {
    double* column = block(s) + static_cast<std::ptrdiff_t>(relative_[at(j)]) * height(s);
    for (int i = j; i < left; ++i) column[relative_[at(i)]] -= product[i];
  }
  passed_[at(from)] += columns;
}

/// Dense Cholesky of a block, a few columns at a time; false if it is not positive definite.
bool SupernodalFactor::factor_block(int s) {
  const std::ptrdiff_t stride = height(s);
  for (int first = 0; first < width(s); first += tile_columns) {
    const int count = std::min(tile_columns, width(s) - first), left = height(s) - first;
    double* panel = block(s) + first * (stride + 1);
    lower_product(block(s) + first, left, count, first, stride, work_.data());
    for (int j = 0; j < count; ++j) {
      double* column = panel + j * stride;
      const double* product = work_.data() + j * product_stride(left);
      for (int i = j; i < left; ++i) column[i] -= product[i];
      for (int e = 0; e < j; ++e) {
        const double* earlier = panel + e * stride;
        const double factor = earlier[j];
        for (int i = j; i < left; ++i) column[i] -= factor * earlier[i];
      }
      if (!(column[j] > 0.0)) return false;
      const double scale = 1.0 / std::sqrt(column[j]);
      for (int i = j; i < left; ++i) column[i] *= scale;
    }
  }
  return true;
}

void SupernodalFactor::solve(Eigen::VectorXd& x) {
  double* y = work_.data();  // x at the rows of a block
  for (int s = 0; s < n_blocks(); ++s) {
    double* own = x.data() + nodes_.first[at(s)];
    if (std::all_of(own, own + width(s), [](double value) { return value == 0.0; })) continue;
    std::copy_n(own, width(s), y);
    std::fill(y + width(s), y + height(s), 0.0);
    const double* column = block(s);
    for (int j = 0; j < width(s); ++j, column += height(s)) {
      own[j] = y[j] /= column[j];
      for (int i = j + 1; i < height(s); ++i) y[i] -= column[i] * own[j];
    }
    for (int i = width(s); i < height(s); ++i) x[rows(s)[i]] += y[i];
  }
  for (int s = n_blocks() - 1; s >= 0; --s) {
    double* own = x.data() + nodes_.first[at(s)];
    for (int i = 0; i < height(s); ++i) y[i] = x[rows(s)[i]];
    const double* column = block(s) + static_cast<std::ptrdiff_t>(width(s)) * height(s);
    for (int j = width(s) - 1; j >= 0; --j) {
      column -= height(s);
      own[j] = y[j] = (y[j] - dot(column + j + 1, y + j + 1, height(s) - j - 1)) / column[j];
    }
  }
}

void SupernodalFactor::solve(RightSides& x) const {
  const int columns = static_cast<int>(x.cols());
  for (int s = 0; s < n_blocks(); ++s) solve_forward(finished(s), x.data(), columns);
  for (int s = n_blocks() - 1; s >= 0; --s) solve_backward(finished(s), x.data(), columns);
}

}  // namespace planar
