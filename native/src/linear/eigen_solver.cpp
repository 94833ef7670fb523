// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/eigen_solver.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

#include "planar/types.h"

namespace planar {

namespace {

using View = Eigen::Map<const Eigen::SparseMatrix<double>>;

View view(const SymmetricMatrix& matrix) {
  return {matrix.size,
          matrix.size,
          static_cast<Eigen::Index>(matrix.row.size()),
          matrix.column_start.data(),
          matrix.row.data(),
          matrix.value.data()};
}

/// Simplicial LDLᵀ; as fast as CHOLMOD's simplicial one, and in headers only.
class EigenSolver final : public SparseSolver {
 public:
  std::vector<int> fill_reducing_order(const SymmetricMatrix& pattern) override {
    SymmetricMatrix ones = pattern;
    ones.value.assign(pattern.row.size(), 1.0);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    const Eigen::SparseMatrix<double> lower = view(ones);
    Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), order);
    return {order.indices().data(), order.indices().data() + order.size()};
  }

  void analyze(const SymmetricMatrix& pattern) override { factor_.analyzePattern(view(pattern)); }

  void factorize(const SymmetricMatrix& matrix) override {
    factor_.factorize(view(matrix));
    // LDLᵀ goes through with pivots that are negative or not a number.
    if (factor_.info() != Eigen::Success || !(factor_.vectorD().array() > 0.0).all()) {
      throw SolveError("the system is not positive definite");
    }
  }

  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) override { x = factor_.solve(b); }

  /// Eigen's own goes through the factor for each of them.
  void solve(RightSides& x) const override {
    Eigen::Index first = 0;
    for (; first + 8 <= x.cols(); first += 8) solve_strip<8>(x, first);
    for (; first + 2 <= x.cols(); first += 2) solve_strip<2>(x, first);
    for (; first < x.cols(); ++first) solve_strip<1>(x, first);
  }

 private:
  template <int width>
  void solve_strip(RightSides& x, Eigen::Index first) const {
    using Row = Eigen::Array<double, 1, width>;
    const auto row_of = [&x, first](Eigen::Index i) { return Eigen::Map<Row>(&x(i, first)); };
    const auto& lower = factor_.matrixL().nestedExpression();  // below the diagonal, which is 1
    const int *start = lower.outerIndexPtr(), *row = lower.innerIndexPtr();
    const double* value = lower.valuePtr();
    for (Eigen::Index j = 0; j < x.rows(); ++j) {
      const Row known = row_of(j);
      for (int k = start[j]; k < start[j + 1]; ++k) row_of(row[k]) -= value[k] * known;
    }
    for (Eigen::Index j = x.rows(); j-- > 0;) {
      Row sum = row_of(j) / factor_.vectorD()[j];
      for (int k = start[j]; k < start[j + 1]; ++k) sum -= value[k] * row_of(row[k]);
      row_of(j) = sum;
    }
  }

  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

}  // namespace

std::unique_ptr<SparseSolver> make_eigen_solver() { return std::make_unique<EigenSolver>(); }

}  // namespace planar
