// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/anderson.h"

#include <cmath>
#include <cstddef>
#include <deque>

#include "linear/least_squares.h"
#include "planar/types.h"

namespace planar {

namespace {

constexpr std::size_t window = 8;  // residuals before the last one that are combined

class Anderson {
 public:
  /// The next x, given the last one and g of it.
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& mapped);
  /// Forgets all residuals.
  void restart();

 private:
  std::deque<Eigen::VectorXd> mapped_change_, residual_change_;
  Eigen::VectorXd last_mapped_, last_residual_;
};

void Anderson::restart() {
  mapped_change_.clear();
  residual_change_.clear();
  last_mapped_.resize(0);
}

Eigen::VectorXd Anderson::next(const Eigen::VectorXd& x, const Eigen::VectorXd& mapped) {
  const Eigen::VectorXd residual = mapped - x;
  if (last_mapped_.size() != 0) {
    mapped_change_.push_back(mapped - last_mapped_);
    residual_change_.push_back(residual - last_residual_);
    if (mapped_change_.size() > window) {
      mapped_change_.pop_front();
      residual_change_.pop_front();
    }
  }
  last_mapped_ = mapped;
  last_residual_ = residual;
  if (residual_change_.empty()) return mapped;
  const auto columns = static_cast<Eigen::Index>(residual_change_.size());
  Eigen::MatrixXd changes(x.size(), columns);
  for (Eigen::Index c = 0; c < columns; ++c) changes.col(c) = residual_change_[static_cast<std::size_t>(c)];
  const Eigen::VectorXd share = least_squares(changes, residual);
  Eigen::VectorXd result = mapped;
  for (Eigen::Index c = 0; c < columns; ++c) result -= share[c] * mapped_change_[static_cast<std::size_t>(c)];
  return result.allFinite() ? result : mapped;
}

}  // namespace

FixedPointOutcome accelerate(
    const std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& mapped)>& step,
    const std::function<bool(const Eigen::VectorXd& x, const Eigen::VectorXd& mapped)>& settled, int budget,
    Eigen::VectorXd& x) {
  FixedPointOutcome outcome;
  Anderson anderson;
  Eigen::VectorXd mapped, plain;  // of x; of the one before, which is where the iteration itself would be
  double last = 0.0;
  bool accelerated = false;
  while (outcome.iterations < budget && !outcome.converged) {
    ++outcome.iterations;
    const double energy = step(x, mapped);
    const bool finite = std::isfinite(energy) && mapped.allFinite();
    if (accelerated && !(finite && energy <= last)) {
      x = plain;
      accelerated = false;
      anderson.restart();
      continue;
    }
    if (!finite) throw SolveError("the energy is not finite: the targets are too far away");
    last = energy;
    plain = mapped;
    outcome.converged = settled(x, mapped);
    x = anderson.next(x, mapped);
    accelerated = true;
  }
  // The last one was not looked at: it is the plain one that is known to lead down.
  if (accelerated) x = plain;
  return outcome;
}

}  // namespace planar
