// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/least_squares.h"

#include <Eigen/QR>

namespace planar {

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double rounding) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor(a.rows(), a.cols());
  factor.setThreshold(rounding);
  factor.compute(a);
  return factor.solve(b);
}

}  // namespace planar
