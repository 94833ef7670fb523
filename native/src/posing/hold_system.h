// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "energy/killing_energy.h"
#include "energy/rest_energy.h"
#include "linear/sparse_solver.h"
#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "parallel/worker.h"

namespace planar {

/// The linear systems of HoldMethod, all with one pattern and one symbolic analysis: a metric at some
/// positions plus the pins' springs, Σ 2μ c cᵀ.
class HoldSystem {
 public:
  enum class Metric {
    none,       ///< no factor
    projected,  ///< the rest energy's Hessian, triangle by triangle semidefinite
    exact,      ///< the rest energy's Hessian
    killing,    ///< 2K of the mesh as it is
  };

  /// \param stiffness m factors, or empty
  HoldSystem(const Mesh& mesh, const Points& rest, const Orientation& orientation,
             const Eigen::VectorXd& stiffness);

  RestEnergy& rest_energy() { return rest_energy_; }
  const std::vector<Pin>& pins() const { return pins_; }
  bool is_active(int vertex) const {
    const int part = mesh_.part[static_cast<std::size_t>(vertex)];
    return part >= 0 && active_[static_cast<std::size_t>(part)];
  }
  /// Parts without a pin are left out of the systems. The factor is lost.
  void set_pins(std::vector<Pin> pins, std::vector<char> active) noexcept;

  /// Factors the metric at x.
  /// \throw SolveError it is not positive definite (`exact`), or no memory
  void factorize(Metric metric, const Points& x);
  /// Starts to factor `projected` at x, in another thread where that pays. Until join() nothing else may be
  /// called.
  void factorize_ahead(const Points& x);
  /// Waits for factorize_ahead(). If that failed there is no factor.
  void join() noexcept;
  void forget() noexcept;

  /// That of the factor.
  Metric metric() const { return metric_; }
  /// Solves with the factor for minus the gradient (n×2).
  void solve(const Points& gradient, Points& direction);
  /// The parts were turned by factors e^{ia} since: so is the metric.
  void turn(const std::vector<std::complex<double>>& by_part);

 private:
  const Mesh& mesh_;
  std::unique_ptr<SparseSolver> solver_;
  KillingMatrix matrix_;
  RestEnergy rest_energy_;
  Eigen::VectorXd stiffness_;
  std::vector<Pin> pins_;
  std::vector<char> active_;  ///< per part: it has a pin

  Metric metric_ = Metric::none;
  std::vector<std::complex<double>> turn_;  ///< per part, since the factor was made
  Eigen::VectorXd unknown_;
  Points ahead_;   ///< where factorize_ahead() factors
  Worker worker_;  ///< last, so that its thread ends before what it uses
};

}  // namespace planar
