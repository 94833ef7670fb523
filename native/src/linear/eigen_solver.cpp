// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/eigen_solver.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

#include "planar/types.h"

namespace planar {

namespace {

template <class Number>
Eigen::Map<const Eigen::SparseMatrix<Number>> view(const SelfAdjointMatrix<Number>& matrix) {
  return {matrix.size,
          matrix.size,
          static_cast<Eigen::Index>(matrix.row.size()),
          matrix.column_start.data(),
          matrix.row.data(),
          matrix.value.data()};
}

/// For what looks at the pattern alone, but copies values.
template <class Number>
SelfAdjointMatrix<Number> ones(const SparsityPattern& pattern) {
  SelfAdjointMatrix<Number> result = pattern;
  result.value.assign(pattern.row.size(), 1.0);
  return result;
}

/// Simplicial LDLᵀ; as fast as CHOLMOD's simplicial one, and in headers only.
template <class Solver>
class EigenSolver : public Solver {
  using Number = typename Solver::Number;
  using Vector = typename Solver::Vector;

 public:
  std::vector<int> fill_reducing_order(const SparsityPattern& pattern) override {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    const SymmetricMatrix matrix = ones<double>(pattern);
    const Eigen::SparseMatrix<double> lower = view(matrix);
    Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), order);
    return {order.indices().data(), order.indices().data() + order.size()};
  }

  void analyze(const SparsityPattern& pattern) override {
    const SelfAdjointMatrix<Number> matrix = ones<Number>(pattern);
    factor_.analyzePattern(view(matrix));
  }

  void factorize(const typename Solver::Matrix& matrix) override {
    factor_.factorize(view(matrix));
    // LDLᵀ goes through with pivots that are negative or not a number.
    if (factor_.info() != Eigen::Success || !(factor_.vectorD().array().real() > 0.0).all()) {
      throw SolveError("the system is not positive definite");
    }
  }

  using Solver::solve;
  void solve(const Vector& b, Vector& x) override { x = factor_.solve(b); }

 protected:
  using Factor =
      Eigen::SimplicialLDLT<Eigen::SparseMatrix<Number>, Eigen::Lower, Eigen::NaturalOrdering<int>>;

  const Factor& factor() const { return factor_; }

 private:
  Factor factor_;
};

class RealEigenSolver final : public EigenSolver<SparseSolver> {
 public:
  using EigenSolver::solve;

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
    const auto& lower = factor().matrixL().nestedExpression();  // below the diagonal, which is 1
    const int *start = lower.outerIndexPtr(), *row = lower.innerIndexPtr();
    const double* value = lower.valuePtr();
    for (Eigen::Index j = 0; j < x.rows(); ++j) {
      const Row known = row_of(j);
      for (int k = start[j]; k < start[j + 1]; ++k) row_of(row[k]) -= value[k] * known;
    }
    for (Eigen::Index j = x.rows(); j-- > 0;) {
      Row sum = row_of(j) / factor().vectorD()[j];
      for (int k = start[j]; k < start[j + 1]; ++k) sum -= value[k] * row_of(row[k]);
      row_of(j) = sum;
    }
  }
};

}  // namespace

std::unique_ptr<SparseSolver> make_eigen_solver() { return std::make_unique<RealEigenSolver>(); }

std::unique_ptr<HermitianSolver> make_eigen_hermitian_solver() {
  return std::make_unique<EigenSolver<HermitianSolver>>();
}

}  // namespace planar
