// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>

namespace planar {

struct FixedPointOutcome {
  int iterations = 0;
  bool converged = false;
};

/// Repeats x <- g(x), g a step that lowers an energy, with Anderson's acceleration: goes where the last
/// residuals g(x) - x, combined linearly, come nearest to 0, and takes back for the plain g(x) what led up
/// [Peng18].
///
/// \param step writes g(x), and gives the energy at x
///
/// \param settled whether the last step, from x to g(x), was small enough
///
/// \param x becomes the last g(x) that is known to lead down
///
/// 	hrow SolveError the energy at the first x, or after a plain step, is not finite
FixedPointOutcome accelerate(
    const std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& mapped)>& step,
    const std::function<bool(const Eigen::VectorXd& x, const Eigen::VectorXd& mapped)>& settled, int budget,
    Eigen::VectorXd& x);

}  // namespace planar
