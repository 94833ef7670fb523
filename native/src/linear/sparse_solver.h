// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <memory>
#include <utility>
#include <vector>

namespace planar {

/// Right sides of a system, each a column. What belongs to an unknown lies next to each other in memory: a
/// factor is passed through once for all of them.
using RightSides = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Where the lower triangle, diagonal included, of a symmetric or Hermitian matrix has entries: by columns,
/// rows ascending in each column (CSC).
struct SparsityPattern {
  int size = 0;
  std::vector<int> column_start;  ///< size + 1
  std::vector<int> row;

  /// Place of an entry of the pattern (row ≥ column) in `row`.
  int find(int i, int column) const;
};

/// The lower triangle of a symmetric matrix of doubles or a Hermitian one of complex numbers.
template <class Number>
struct SelfAdjointMatrix : SparsityPattern {
  std::vector<Number> value;  ///< those of `row`; what is behind them is ignored

  SelfAdjointMatrix() = default;
  /// Without values.
  SelfAdjointMatrix(SparsityPattern pattern) : SparsityPattern(std::move(pattern)) {}

  /// The product with a vector.
  Eigen::VectorX<Number> times(const Eigen::VectorX<Number>& x) const;
};

using SymmetricMatrix = SelfAdjointMatrix<double>;
using HermitianMatrix = SelfAdjointMatrix<std::complex<double>>;

/// The pattern with the whole diagonal and an entry for each edge of a graph over `size` unknowns.
SparsityPattern graph_pattern(int size, const std::vector<std::array<int, 2>>& edges);

/// The same for two unknowns in place of each: 2i and 2i + 1 for i, all four entries of a pair.
SparsityPattern doubled_pattern(const SparsityPattern& graph);

enum class Backend { cholmod, eigen };

/// CHOLMOD where the library was built with it, else Eigen.
Backend default_backend();

/// Direct solver for positive definite systems, symmetric or Hermitian, whose pattern stays while the values
/// change. It factors in the order of the unknowns, so the caller numbers them well once and assembles
/// straight into that order: \code
///   auto solver = SparseSolver::create(default_backend());
///   order = solver->fill_reducing_order(pattern);  // number the unknowns by it, build `a` in that numbering
///   solver->analyze(a);                            // once per pattern
///   solver->factorize(a);                          // whenever the values change
///   solver->solve(b, x);                           // for every right side
/// \endcode
/// A solver is used by one thread at a time, but for the solve that says otherwise, and factors in that
/// thread alone, so results do not depend on the number of threads.
template <class Scalar>
class CholeskySolver {
 public:
  using Number = Scalar;
  using Matrix = SelfAdjointMatrix<Number>;
  using Vector = Eigen::VectorX<Number>;

  virtual ~CholeskySolver() = default;

  /// order[k] is the old number of the k-th unknown in an order in which the factor of this pattern stays
  /// sparse.
  virtual std::vector<int> fill_reducing_order(const SparsityPattern& pattern) = 0;
  /// \throw SolveError no memory, or a pattern too large
  virtual void analyze(const SparsityPattern& pattern) = 0;
  /// \throw SolveError not positive definite, or no memory; the symbolic analysis stays
  virtual void factorize(const Matrix& matrix) = 0;
  /// x = A⁻¹ b with the last factor; b and x may be the same vector.
  virtual void solve(const Vector& b, Vector& x) = 0;
};

class SparseSolver : public CholeskySolver<double> {
 public:
  /// \throw std::invalid_argument the library was built without that backend
  static std::unique_ptr<SparseSolver> create(Backend backend);

  using CholeskySolver::solve;
  /// x ← A⁻¹ x with the last factor, for several right sides (complex ones are two) in one pass. Works in x
  /// alone: threads may share the solver for it. What a column becomes depends on no other.
  virtual void solve(RightSides& x) const = 0;
};

/// A factor of complex numbers takes half of the memory and arithmetic of the one of the real matrix of twice
/// the size with [a -b; b a] for each a + ib.
class HermitianSolver : public CholeskySolver<std::complex<double>> {
 public:
  /// \throw std::invalid_argument the library was built without that backend
  static std::unique_ptr<HermitianSolver> create(Backend backend);
};

}  // namespace planar
