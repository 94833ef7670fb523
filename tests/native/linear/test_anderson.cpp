// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "linear/anderson.h"
#include "planar/types.h"

namespace planar::testing {
namespace {

TEST(Anderson, SolvesALinearFixedPointInAsManyStepsAsItHasDimensions) {
  // Steps down the gradient of x'(1 - m)x/2 - b'x.
  Eigen::MatrixXd m(5, 5);
  Eigen::VectorXd b(5);
  for (int i = 0; i < 5; ++i) {
    b[i] = std::sin(1.0 + 2.0 * i);
    for (int j = 0; j < 5; ++j) m(i, j) = std::cos(1.7 * (i + j) + i * j);
  }
  m *= 0.95 / m.norm();
  const auto step = [&](const Eigen::VectorXd& x, Eigen::VectorXd& mapped) {
    mapped = m * x + b;
    return 0.5 * x.dot(x - m * x) - b.dot(x);
  };
  const auto settled = [](const Eigen::VectorXd& x, const Eigen::VectorXd& mapped) {
    return (mapped - x).norm() < 1e-9;
  };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(5);
  const FixedPointOutcome outcome = accelerate(step, settled, 100, x);
  EXPECT_TRUE(outcome.converged);
  EXPECT_LE(outcome.iterations, 8);
  EXPECT_LT((m * x + b - x).norm(), 1e-9);
}

TEST(Anderson, NeverEndsHigherThanThePlainIteration) {
  // Down a slope that is steep on one side and shallow on the other, where extrapolation goes too far.
  const auto energy = [](double x) { return std::exp(-3.0 * x) + 0.01 * x; };
  const auto step = [&](const Eigen::VectorXd& x, Eigen::VectorXd& mapped) {
    mapped = x.array() + 0.1 * (3.0 * (-3.0 * x.array()).exp() - 0.01);
    return energy(x[0]);
  };
  const auto never = [](const Eigen::VectorXd&, const Eigen::VectorXd&) { return false; };
  for (int budget = 1; budget <= 30; ++budget) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(1), mapped;
    EXPECT_EQ(accelerate(step, never, budget, x).iterations, budget);
    EXPECT_LT(energy(x[0]), energy(0.0)) << budget;
  }
}

TEST(Anderson, RefusesAnEnergyThatIsNoNumber) {
  const auto step = [](const Eigen::VectorXd& x, Eigen::VectorXd& mapped) {
    mapped = x;
    return NAN;
  };
  const auto never = [](const Eigen::VectorXd&, const Eigen::VectorXd&) { return false; };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
  EXPECT_THROW(accelerate(step, never, 3, x), SolveError);
}

}  // namespace
}  // namespace planar::testing
