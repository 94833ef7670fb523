// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

namespace planar {

/// Right sides of a system, each a column. What belongs to an unknown lies next to each other in memory: a
/// factor is passed through once for all of them.
using RightSides = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Lower triangle, diagonal included, of a symmetric matrix by columns, rows ascending in each column (CSC).
/// `value` may be longer than the pattern; the rest is ignored.
struct SymmetricMatrix {
  int size = 0;
  std::vector<int> column_start;  ///< size + 1
  std::vector<int> row;
  std::vector<double> value;

  /// Place of an entry of the pattern (row ≥ column) in `row` and `value`.
  int find(int i, int column) const;
  /// The product with a vector.
  Eigen::VectorXd times(const Eigen::VectorXd& x) const;
};

/// The pattern with the whole diagonal and an entry for each edge of a graph over `size` unknowns.
SymmetricMatrix graph_pattern(int size, const std::vector<std::array<int, 2>>& edges);

/// The same for two unknowns in place of each: 2i and 2i + 1 for i, all four entries of a pair.
SymmetricMatrix doubled_pattern(const SymmetricMatrix& graph);

enum class Backend { cholmod, eigen };

/// CHOLMOD where the library was built with it, else Eigen.
Backend default_backend();

/// Direct solver for symmetric positive definite systems whose pattern stays while the values change. It
/// factors in the order of the unknowns, so the caller numbers them well once and assembles straight into
/// that order:
/// \code
///   auto solver = SparseSolver::create(default_backend());
///   order = solver->fill_reducing_order(pattern);  // number the unknowns by it, build `a` in that numbering
///   solver->analyze(a);                            // once per pattern
///   solver->factorize(a);                          // whenever the values change
///   solver->solve(b, x);                           // for every right side
/// \endcode
/// A solver is used by one thread at a time, but for the solve that says otherwise, and factors in that
/// thread alone, so results do not depend on the number of threads.
class SparseSolver {
 public:
  /// \throw std::invalid_argument the library was built without that backend
  static std::unique_ptr<SparseSolver> create(Backend backend);
  virtual ~SparseSolver() = default;

  /// order[k] is the old number of the k-th unknown in an order in which the factor of this pattern stays
  /// sparse.
  virtual std::vector<int> fill_reducing_order(const SymmetricMatrix& pattern) = 0;
  /// \throw SolveError no memory, or a pattern too large
  virtual void analyze(const SymmetricMatrix& pattern) = 0;
  /// \throw SolveError not positive definite, or no memory; the symbolic analysis stays
  virtual void factorize(const SymmetricMatrix& matrix) = 0;
  /// x = A⁻¹ b with the last factor; b and x may be the same vector.
  virtual void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) = 0;
  /// x ← A⁻¹ x with the last factor, for several right sides (complex ones are two) in one pass. Works in x
  /// alone: threads may share the solver for it. What a column becomes depends on no other.
  virtual void solve(RightSides& x) const = 0;
};

}  // namespace planar
