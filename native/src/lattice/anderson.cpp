// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/anderson.h"

#include <utility>

#include "linear/least_squares.h"

namespace planar {

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
    if (mapped_change_.size() > window_) {
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

}  // namespace planar
