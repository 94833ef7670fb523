// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "energy/killing_energy.h"
#include "energy/rest_energy.h"
#include "linear/sparse_solver.h"
#include "mesh/mesh.h"

namespace planar {

/// A quadratic term beside the rest energy, Σ w |Σ_c b_c x_c - p|²: pins, or a pull towards another shape.
class Springs {
 public:
  virtual ~Springs() = default;
  /// The term at x; its derivatives are added to `gradient` (n×2) if there is one.
  virtual double value(const Points& x, Points* gradient) const = 0;
  /// Adds `scale` times the Hessian, Σ 2w b bᵀ.
  virtual void add_hessian(MeshMatrix& matrix, double scale) const = 0;
};

/// The linear systems of Newton, all with one pattern and one symbolic analysis: a metric at some positions
/// plus the springs' Hessian.
class NewtonSystem {
 public:
  enum class Metric {
    none,       ///< no factor
    newton,     ///< the rest energy's Hessian
    projected,  ///< the same, triangle by triangle semidefinite
    killing,    ///< 2K of the mesh as it is
  };

  /// \param mesh, springs must outlive this
  /// \param stiffness m factors, or empty
  NewtonSystem(const Mesh& mesh, const Springs& springs, const Eigen::VectorXd& stiffness);

  /// From now on the springs couple these pairs of vertices, too, which costs a new analysis. The factor is
  /// lost, and elements of the matrix change.
  /// \throw SolveError no memory
  void link(const std::vector<std::array<int, 2>>& pairs);

  const Mesh& mesh() const { return mesh_; }
  const Eigen::VectorXd& stiffness() const { return stiffness_; }
  const Springs& springs() const { return springs_; }
  const MeshMatrix& matrix() const { return matrix_; }

  bool is_active(int vertex) const {
    const int part = mesh_.part[static_cast<std::size_t>(vertex)];
    return part >= 0 && active_[static_cast<std::size_t>(part)];
  }
  /// Parts that are not active (a flag a part; at first all are) are left out of the systems. The factor is
  /// lost.
  void set_active(std::vector<char> active) noexcept;

  /// Factors the metric of `scale` times the energy at x.
  /// \throw SolveError the metric is not finite or, Newton's own, not positive definite; or no memory
  void factorize(Metric metric, const RestEnergy& energy, double scale, const Points& x);
  void forget() noexcept { metric_ = Metric::none; }

  /// That of the factor.
  Metric metric() const { return metric_; }
  /// Solves with the factor for minus the gradient (n×2).
  void solve(const Points& gradient, Points& direction);
  /// Takes the direction that solve() gave towards Newton's own at x, that of the Hessian with its negative
  /// curvature, by a few steps of conjugate gradients with the factor as preconditioner. They end where they
  /// meet a direction of negative curvature, the first of which solve() has given: the result is one of
  /// descent. [Nocedal06, algorithm 7.1]
  void approach_newton(const RestEnergy& energy, double scale, const Points& x, const Points& gradient,
                       Points& direction);
  /// The parts were turned by factors e^{ia} since: so is the metric.
  void turn(const std::vector<std::complex<double>>& by_part);

 private:
  const Mesh& mesh_;
  const Springs& springs_;
  std::unique_ptr<SparseSolver> solver_;
  KillingMatrix matrix_;  ///< of what was factored last, or multiplied with
  Eigen::VectorXd stiffness_;
  std::vector<char> active_;

  void scale_and_add_springs(double scale, double springs);
  Points times(const Points& x) const;

  Metric metric_ = Metric::none;
  std::vector<std::complex<double>> turn_;  ///< per part, since the factor was made
  Eigen::VectorXd unknown_;
};

}  // namespace planar
