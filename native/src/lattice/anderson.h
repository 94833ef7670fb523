// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <deque>

namespace planar {

/// Anderson's acceleration of a fixed-point iteration x <- g(x): goes where the last residuals g(x) - x,
/// combined linearly, come nearest to 0.
class Anderson {
 public:
  /// \param window how many residuals before the last one are combined
  explicit Anderson(std::size_t window) : window_(window) {}

  /// The next x, given the last one and g of it.
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& mapped);
  /// Forgets all residuals.
  void restart();

 private:
  std::size_t window_;
  std::deque<Eigen::VectorXd> mapped_change_, residual_change_;
  Eigen::VectorXd last_mapped_, last_residual_;
};

}  // namespace planar
