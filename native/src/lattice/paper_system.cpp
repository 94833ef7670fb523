// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/paper_system.h"

#include <utility>

#include "base/index.h"

namespace planar {

namespace {

// Of the mean of the diagonal, where the matrix is singular without: nothing holds points that nothing
// touches.
constexpr double regularization = 1e-10;
constexpr double most_regularization = 1e-2;

}  // namespace

template <int D>
PaperSystem<D>::PaperSystem(RingEnergy<D> rings, const Rows<D>& lattice_rest,
                            const std::vector<std::array<int, 2>>& coupled, double shape_weight,
                            double rest_weight, bool rigid_following)
    : rings_(std::move(rings)),
      lattice_rest_(lattice_rest),
      shape_weight_(shape_weight),
      rest_weight_(rest_weight),
      rigid_following_(rigid_following),
      matrix_(static_cast<int>(lattice_rest.rows()), coupled, 1) {
  rings_.add_squares(matrix_, shape_weight);
  shape_values_ = matrix_.values();
}

template <int D>
void PaperSystem<D>::compile(const LatticeSprings<D>& springs) {
  matrix_.set_values(shape_values_);
  const LatticeWeights& rows = springs.rows;
  for (Eigen::Index h = 0; h < rows.rows(); ++h) {
    const int from = rows.outerIndexPtr()[h], to = rows.outerIndexPtr()[h + 1];
    const std::vector<int> points(rows.innerIndexPtr() + from, rows.innerIndexPtr() + to);
    matrix_.add_square(points, rows.valuePtr() + from, springs.weight[h]);
  }
  for (int p = 0; p < static_cast<int>(lattice_rest_.rows()); ++p) {
    const double one = 1.0;
    matrix_.add_square({p}, &one, springs.is_point[at(p)] ? springs.point_weight : rest_weight_);
  }
  matrix_.fix(springs.locked);
  const double scale = matrix_.scale();
  for (double more = regularization;; more *= 1e4) {
    try {
      matrix_.factorize();
      return;
    } catch (const SolveError&) {
      if (more > most_regularization) throw;
    }
    matrix_.add_to_diagonal(more * scale);
  }
}

template <int D>
double PaperSystem<D>::step(const LatticeSprings<D>& springs, const Rows<D>& d, Rows<D>* next) {
  force_.setZero(d.rows(), D);
  double energy = springs.value(d, &force_);
  force_ *= -0.5;
  Rows<D> ring_force = Rows<D>::Zero(d.rows(), D);
  energy += shape_weight_ * rings_.value(d, &ring_force);
  force_ += shape_weight_ * ring_force;
  Motion<D> motion{Eigen::Matrix<double, 1, D>::Zero(), Eigen::Matrix<double, 1, D>::Zero(),
                   Eigen::Matrix<double, D, D>::Identity()};
  if (rigid_following_) motion = rings_.motion();
  for (Eigen::Index p = 0; p < d.rows(); ++p) {
    if (springs.is_point[at(p)]) continue;
    const Eigen::Matrix<double, 1, D> at_rest = lattice_rest_.row(p);
    const Eigen::Matrix<double, 1, D> off = (motion.at(at_rest) - at_rest) - d.row(p);
    energy += rest_weight_ * off.squaredNorm();
    force_.row(p) += rest_weight_ * off;
  }
  if (next == nullptr) return energy;
  for (Eigen::Index p = 0; p < d.rows(); ++p) {
    if (springs.locked[at(p)]) force_.row(p).setZero();
  }
  side_ = force_;
  matrix_.solve(side_);
  *next = d + side_;
  return energy;
}

template class PaperSystem<2>;
template class PaperSystem<3>;

}  // namespace planar
