// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/cholmod_solver.h"

#include <cholmod.h>

#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "linear/supernodal_factor.h"
#include "planar/types.h"

namespace planar {

namespace {

/// A view; CHOLMOD does not write to it, but its types are not const.
cholmod_sparse view(const SparsityPattern& pattern) {
  cholmod_sparse result{};
  result.nrow = result.ncol = static_cast<std::size_t>(pattern.size);
  result.nzmax = pattern.row.size();
  result.p = const_cast<int*>(pattern.column_start.data());
  result.i = const_cast<int*>(pattern.row.data());
  result.stype = -1;
  result.itype = CHOLMOD_INT;
  result.xtype = CHOLMOD_PATTERN;
  result.dtype = CHOLMOD_DOUBLE;
  result.sorted = 1;
  result.packed = 1;
  return result;
}

/// CHOLMOD orders and analyses; the numbers are SupernodalFactor's.
template <class Solver>
class CholmodSolver : public Solver {
 public:
  CholmodSolver() {
    if (!cholmod_start(&common_)) throw SolveError("CHOLMOD cannot start");
    common_.print = 0;
    common_.try_catch = 1;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    // Larger supernodes than by default, at the price of explicit zeros: a tenth faster on meshes of 1k to
    // 50k vertices.
    common_.nrelax[0] = 12;
    common_.nrelax[1] = 24;
    common_.nrelax[2] = 48;
    common_.zrelax[0] = 0.9;
    common_.zrelax[1] = 0.3;
    common_.zrelax[2] = 0.05;
  }

  ~CholmodSolver() override { cholmod_finish(&common_); }

  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  std::vector<int> fill_reducing_order(const SparsityPattern& pattern) override {
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.postorder = 1;
    cholmod_sparse a = view(pattern);
    cholmod_factor* ordered = cholmod_analyze(&a, &common_);
    if (ordered == nullptr) fail();
    const int* order = static_cast<const int*>(ordered->Perm);
    std::vector<int> result(order, order + pattern.size);
    cholmod_free_factor(&ordered, &common_);
    return result;
  }

  void analyze(const SparsityPattern& pattern) override {
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 0;
    cholmod_sparse a = view(pattern);
    cholmod_factor* analyzed = cholmod_analyze(&a, &common_);
    if (analyzed == nullptr) fail();
    const auto numbers = [](const void* from, std::size_t count) {
      const int* first = static_cast<const int*>(from);
      return std::vector<int>(first, first + count);
    };
    const std::size_t count = analyzed->nsuper;
    Supernodes nodes{numbers(analyzed->super, count + 1), numbers(analyzed->pi, count + 1),
                     numbers(analyzed->s, analyzed->ssize)};
    cholmod_free_factor(&analyzed, &common_);
    try {
      factor_.emplace(std::move(nodes));
    } catch (const std::bad_alloc&) {
      throw SolveError("out of memory for the factor of the system");
    }
  }

  void factorize(const typename Solver::Matrix& matrix) override {
    if (!factor_->factorize(matrix)) throw SolveError("the system is not positive definite");
  }

  using Solver::solve;
  void solve(const typename Solver::Vector& b, typename Solver::Vector& x) override {
    if (&x != &b) x = b;
    factor_->solve(x);
  }

 protected:
  const SupernodalFactor<typename Solver::Number>& factor() const { return *factor_; }

 private:
  [[noreturn]] void fail() const {
    switch (common_.status) {
      case CHOLMOD_OUT_OF_MEMORY:
        throw SolveError("out of memory while analysing the system");
      case CHOLMOD_TOO_LARGE:
        throw SolveError("the system is too large to factor");
      default:
        throw SolveError("CHOLMOD failed with status " + std::to_string(common_.status));
    }
  }

  cholmod_common common_{};
  std::optional<SupernodalFactor<typename Solver::Number>> factor_;
};

class RealCholmodSolver final : public CholmodSolver<SparseSolver> {
 public:
  using CholmodSolver::solve;
  void solve(RightSides& x) const override { factor().solve(x); }
};

}  // namespace

std::unique_ptr<SparseSolver> make_cholmod_solver() { return std::make_unique<RealCholmodSolver>(); }

std::unique_ptr<HermitianSolver> make_cholmod_hermitian_solver() {
  return std::make_unique<CholmodSolver<HermitianSolver>>();
}

}  // namespace planar
