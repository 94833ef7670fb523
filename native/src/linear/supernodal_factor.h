// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstddef>
#include <vector>

#include "base/index.h"
#include "linear/block_solve.h"
#include "linear/sparse_solver.h"

namespace planar {

/// Columns of a Cholesky factor with nearly the same rows, to be stored as dense blocks: block s has the
/// columns first[s] to first[s + 1] - 1, and the rows row[row_start[s]] to row[row_start[s + 1] - 1],
/// ascending, which start with those of its own columns.
struct Supernodes {
  std::vector<int> first;      ///< blocks + 1
  std::vector<int> row_start;  ///< blocks + 1
  std::vector<int> row;
};

/// The numbers of a sparse LLᴴ, of doubles or complex ones, left-looking by blocks [Ng93], in the calling
/// thread. Takes 0.2 to 0.55 of the time of CHOLMOD's own with OpenBLAS 0.3.21 on meshes of 1k to 100k
/// vertices (0.3 to 1.3 on processors without AVX2): the blocks of a mesh in the plane are small, so that
/// BLAS calls and OpenMP regions cost more than the arithmetic, and two threads that factor wait for each
/// other in both.
template <class Number>
class SupernodalFactor {
 public:
  using Vector = Eigen::VectorX<Number>;

  explicit SupernodalFactor(Supernodes supernodes);

  /// False if the matrix, whose pattern the supernodes must cover, is not positive definite.
  bool factorize(const SelfAdjointMatrix<Number>& matrix);

  /// x ← A⁻¹ x. Blocks before which there is nothing in x are passed over, which saves most of the first of
  /// two sweeps for right sides of a few handles.
  void solve(Vector& x);

  /// The same for a right side a column; in several threads at once if need be.
  template <std::same_as<RightSides> Sides>  // of doubles alone, so that it is not made of complex numbers
  void solve(Sides& x) const {
    const int columns = static_cast<int>(x.cols());
    const auto finished = [this](int s) {
      return FactorBlock{value_.data() + start_[at(s)], width(s), height(s), rows(s)};
    };
    for (int s = 0; s < n_blocks(); ++s) solve_forward(finished(s), x.data(), columns);
    for (int s = n_blocks() - 1; s >= 0; --s) solve_backward(finished(s), x.data(), columns);
  }

 private:
  void gather(int s, const SelfAdjointMatrix<Number>& matrix);
  void subtract(int from, int s);
  bool factor_block(int s);
  void queue(int s);

  int n_blocks() const { return static_cast<int>(start_.size()); }
  int width(int s) const { return nodes_.first[at(s) + 1] - nodes_.first[at(s)]; }
  int height(int s) const { return nodes_.row_start[at(s) + 1] - nodes_.row_start[at(s)]; }
  const int* rows(int s) const { return nodes_.row.data() + nodes_.row_start[at(s)]; }
  Number* block(int s) { return value_.data() + start_[at(s)]; }

  Supernodes nodes_;
  std::vector<std::size_t> start_;  ///< of each block's values
  std::vector<int> owner_;          ///< the block of each column
  std::vector<Number> value_;       ///< by columns
  std::vector<double> work_;        ///< products
  Vector rows_of_x_;                ///< x at the rows of a block
  std::vector<int> place_;          ///< of a row in the block under way
  std::vector<int> relative_;       ///< places of the rows of another block
  /// Finished blocks wait in a list at the block that they change next; passed_ counts the rows that belong
  /// to blocks before that.
  std::vector<int> waiting_, next_waiting_, passed_;
};

}  // namespace planar
