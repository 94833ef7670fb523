// SPDX-License-Identifier: GPL-3.0-or-later
#include "cholmod_solver.h"

#include <cholmod.h>
#if CHOLMOD_MAIN_VERSION < 4
#include <omp.h>
#endif

#include <mutex>

#include "planar/types.h"

#ifdef __linux__
// Not declared by any header that CHOLMOD's users need; absent where another BLAS is behind it.
extern "C" {
[[gnu::weak]] void openblas_set_num_threads(int n_threads);
[[gnu::weak]] int openblas_get_parallel();
}
#endif

namespace planar {

namespace {

/// Settles how CHOLMOD's BLAS is called when OpenBLAS is behind it. Its threads are switched off, in the
/// whole process: they never paid for blocks of this size, and only without them are results the same on
/// every machine. And where it was built for single threaded programs (Debian's libopenblas0-serial), two
/// threads corrupt each other's buffers, so that calls must take turns.
class BlasTurn {
 public:
#ifdef __linux__
  BlasTurn() {
    static const bool take_turns = [] {
      if (openblas_set_num_threads) openblas_set_num_threads(1);
      return openblas_get_parallel && openblas_get_parallel() == 0;
    }();
    static std::mutex mutex;
    if (take_turns) lock_ = std::unique_lock(mutex);
  }

 private:
  std::unique_lock<std::mutex> lock_;
#endif
};

/// Keeps CHOLMOD to the calling thread: its threads, opened anew for each supernode, cost more than they
/// save. CHOLMOD 3 fixes their number when it is compiled, so there OpenMP's levels are switched off for this
/// thread, and put back after.
class OneThread {
 public:
#if CHOLMOD_MAIN_VERSION < 4
  explicit OneThread(cholmod_common&) : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(levels_); }

 private:
  int levels_;
#else
  explicit OneThread(cholmod_common& common) { common.nthreads_max = 1; }
  ~OneThread() = default;
#endif

 public:
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;
};

/// A view; CHOLMOD does not write to it, but its types are not const.
cholmod_sparse view(const SymmetricMatrix& matrix, bool with_values) {
  cholmod_sparse result{};
  result.nrow = result.ncol = static_cast<std::size_t>(matrix.size);
  result.nzmax = matrix.row.size();
  result.p = const_cast<int*>(matrix.column_start.data());
  result.i = const_cast<int*>(matrix.row.data());
  result.x = with_values ? const_cast<double*>(matrix.value.data()) : nullptr;
  result.stype = -1;
  result.itype = CHOLMOD_INT;
  result.xtype = with_values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  result.dtype = CHOLMOD_DOUBLE;
  result.sorted = 1;
  result.packed = 1;
  return result;
}

class CholmodSolver final : public SparseSolver {
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

  ~CholmodSolver() override {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_, &common_);
    cholmod_free_dense(&e_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  std::vector<int> fill_reducing_order(const SymmetricMatrix& pattern) override {
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.postorder = 1;
    cholmod_sparse a = view(pattern, false);
    cholmod_factor* ordered = cholmod_analyze(&a, &common_);
    if (ordered == nullptr) fail();
    const int* order = static_cast<const int*>(ordered->Perm);
    std::vector<int> result(order, order + pattern.size);
    cholmod_free_factor(&ordered, &common_);
    return result;
  }

  void analyze(const SymmetricMatrix& pattern) override {
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 0;
    cholmod_sparse a = view(pattern, false);
    cholmod_factor* factor = cholmod_analyze(&a, &common_);
    if (factor == nullptr) fail();
    cholmod_free_factor(&factor_, &common_);
    factor_ = factor;
  }

  void factorize(const SymmetricMatrix& matrix) override {
    const BlasTurn turn;
    const OneThread guard(common_);
    cholmod_sparse a = view(matrix, true);
    if (!cholmod_factorize(&a, factor_, &common_) || common_.status != CHOLMOD_OK) fail();
  }

  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) override {
    const BlasTurn turn;
    const OneThread guard(common_);
    cholmod_dense right{};
    right.nrow = right.d = right.nzmax = static_cast<std::size_t>(b.size());
    right.ncol = 1;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    // The workspaces x_, y_ and e_ are kept from solve to solve.
    if (!cholmod_solve2(CHOLMOD_A, factor_, &right, nullptr, &x_, nullptr, &y_, &e_, &common_)) fail();
    x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(x_->x), b.size());
  }

 private:
  [[noreturn]] void fail() const {
    switch (common_.status) {
      case CHOLMOD_NOT_POSDEF:
        throw SolveError("the system is not positive definite");
      case CHOLMOD_OUT_OF_MEMORY:
        throw SolveError("out of memory while factoring the system");
      case CHOLMOD_TOO_LARGE:
        throw SolveError("the system is too large to factor");
      default:
        throw SolveError("CHOLMOD failed with status " + std::to_string(common_.status));
    }
  }

  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* x_ = nullptr;
  cholmod_dense* y_ = nullptr;
  cholmod_dense* e_ = nullptr;
};

}  // namespace

std::unique_ptr<SparseSolver> make_cholmod_solver() { return std::make_unique<CholmodSolver>(); }

}  // namespace planar
