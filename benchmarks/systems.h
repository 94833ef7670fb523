// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "energy/killing_energy.h"
#include "linear/sparse_solver.h"
#include "shapes.h"

namespace planar::benchmarks {

/// The Killing system of a mesh with two soft handles (without any it is singular), and the library's solver.
class OwnSystem {
 public:
  explicit OwnSystem(const Shape& shape);
  void assemble(const Shape& shape);
  const SymmetricMatrix& matrix() const { return killing_->matrix(); }
  void factorize() { solver_->factorize(killing_->matrix()); }
  /// For forces at the handles.
  void solve();

 private:
  Mesh mesh_;
  std::unique_ptr<SparseSolver> solver_;
  std::optional<KillingMatrix> killing_;
  Eigen::VectorXd unknown_;
};

/// The measure of everything here: CHOLMOD's own numeric factorization (supernodal LLᵀ, AMD, its BLAS, one
/// thread) of a system.
class BareSystem {
 public:
  /// \param lower stays alive
  explicit BareSystem(const SymmetricMatrix& lower);
  ~BareSystem();
  BareSystem(const BareSystem&) = delete;
  BareSystem& operator=(const BareSystem&) = delete;

  void factorize();

 private:
  cholmod_common common_{};
  cholmod_sparse matrix_{};
  cholmod_factor* factor_ = nullptr;
};

double milliseconds(auto&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The value that a share of all values is not above.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

}  // namespace planar::benchmarks
