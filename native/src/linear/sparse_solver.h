// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace planar {

/// Lower triangle, diagonal included, of a symmetric matrix by columns, rows ascending in each column (CSC).
/// `value` may be longer than the pattern; the rest is ignored.
struct SymmetricMatrix {
  int size = 0;
  std::vector<int> column_start;  ///< size + 1
  std::vector<int> row;
  std::vector<double> value;
};

enum class Backend { cholmod, eigen };

/// CHOLMOD where the library was built with it, else Eigen.
Backend default_backend();

/// Direct solver for symmetric positive definite systems whose pattern stays while the values change. It
/// factors in the order of the unknowns, so the caller numbers them well once and assembles straight into
/// that order: \code
///   auto solver = SparseSolver::create(default_backend());
///   order = solver->fill_reducing_order(pattern);  // number the unknowns by it, then build `a` in that
///   numbering solver->analyze(a);                            // once per pattern solver->factorize(a); //
///   whenever the values change solver->solve(b, x);                           // for every right side
/// \endcode
/// A solver is used by one thread at a time and factors in that thread alone, so results do not depend on the
/// number of threads.
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
};

}  // namespace planar
