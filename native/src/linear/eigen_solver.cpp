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
    // LDLᵀ goes through with negative pivots, so the sign has to be looked at.
    if (factor_.info() != Eigen::Success || !(factor_.vectorD().minCoeff() > 0.0)) {
      throw SolveError("the system is not positive definite");
    }
  }

  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) override { x = factor_.solve(b); }

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

}  // namespace

std::unique_ptr<SparseSolver> make_eigen_solver() { return std::make_unique<EigenSolver>(); }

}  // namespace planar
