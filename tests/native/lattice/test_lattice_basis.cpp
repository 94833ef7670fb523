// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "lattice/lattice_support.h"

namespace planar::testing {
namespace {

/// Weights along one axis, a value a point, in plain words: BLENDER's key_curve_position_weights() between
/// four points that are clamped to those there are, or [LPFFD 2] of degree count - 1.
Eigen::VectorXd dense_axis(LatticeBasis basis, int count, double s) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(count);
  if (count == 1) {
    w[0] = 1.0;
    return w;
  }
  if (basis == LatticeBasis::bernstein) {
    const double t = std::min(1.0, std::max(0.0, s / (count - 1)));
    for (int k = 0; k < count; ++k) {
      double binomial = 1.0;
      for (int i = 1; i <= k; ++i) binomial *= static_cast<double>(count - i) / i;
      w[k] = binomial * std::pow(t, k) * std::pow(1.0 - t, count - 1 - k);
    }
    return w;
  }
  const double k = std::floor(s), t = s - k, t2 = t * t, t3 = t * t * t;
  double b[4] = {0.0, 1.0 - t, t, 0.0};
  if (basis == LatticeBasis::bspline) {
    b[0] = (1.0 - t) * (1.0 - t) * (1.0 - t) / 6.0;
    b[1] = (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0;
    b[2] = (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0;
    b[3] = t3 / 6.0;
  } else if (basis != LatticeBasis::linear) {
    const double c = basis == LatticeBasis::cardinal ? 0.71 : 0.5;
    b[0] = -c * t3 + 2.0 * c * t2 - c * t;
    b[1] = (2.0 - c) * t3 + (c - 3.0) * t2 + 1.0;
    b[2] = (c - 2.0) * t3 + (3.0 - 2.0 * c) * t2 + c * t;
    b[3] = c * t3 - c * t2;
  }
  for (int i = 0; i < 4; ++i) {
    w[static_cast<Eigen::Index>(std::min<double>(count - 1, std::max<double>(0, k - 1 + i)))] += b[i];
  }
  return w;
}

LatticeGrid mixed(const std::vector<int>& count, const std::vector<LatticeBasis>& basis) {
  const auto n = static_cast<Eigen::Index>(count.size());
  return {count, basis, Eigen::VectorXd::LinSpaced(n, -0.9, -0.4), Eigen::VectorXd::LinSpaced(n, 0.3, 0.17)};
}

class Bases : public ::testing::TestWithParam<LatticeBasis> {};

TEST_P(Bases, RowsSumToOneInsideAndFarOutside) {
  for (const int count : {1, 2, 3, 5, 14, 64}) {
    const LatticeGrid grid = mixed({count, 3}, {GetParam(), LatticeBasis::linear});
    const Coordinates places = 3.0 * random_coordinates(200, 2, 1);
    const LatticeWeights w = lattice_weights(places, grid);
    const LatticeWeights far = lattice_weights(1e12 * places, grid);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(w.cols());
    EXPECT_LT((w * ones - Eigen::VectorXd::Ones(200)).cwiseAbs().maxCoeff(), 1e-14) << count;
    EXPECT_LT((far * ones - Eigen::VectorXd::Ones(200)).cwiseAbs().maxCoeff(), 1e-14) << count;
  }
}

TEST_P(Bases, AreThoseOfADenseReading) {
  for (const int other : {1, 2, 7}) {
    const LatticeGrid grid =
        mixed({6, other, 4}, {GetParam(), LatticeBasis::bspline, LatticeBasis::catmull_rom});
    const Coordinates places = 2.0 * random_coordinates(300, 3, 2);
    const LatticeWeights w = lattice_weights(places, grid);
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      std::vector<Eigen::VectorXd> axis;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto k = static_cast<Eigen::Index>(a);
        axis.push_back(
            dense_axis(grid.basis[a], grid.count[a], (places(i, k) - grid.origin[k]) / grid.spacing[k]));
      }
      for (int p = 0; p < w.cols(); ++p) {
        const double expected = axis[0][p % 6] * axis[1][p / 6 % other] * axis[2][p / (6 * other)];
        EXPECT_NEAR(w.coeff(i, p), expected, 1e-14) << i << " " << p;
      }
    }
  }
}

TEST_P(Bases, OutsideTheDisplacementIsThatOfTheBorder) {
  const LatticeGrid grid = mixed({5, 4}, {GetParam(), GetParam()});
  Coordinates far(2, 2), further(2, 2);
  far << -10.0, 0.1, 0.2, 10.0;
  further << -20.0, 0.1, 0.2, 35.0;
  const Eigen::MatrixXd a = lattice_weights(far, grid), b = lattice_weights(further, grid);
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-15);
}

TEST_P(Bases, ReproduceTheirPlacesWithAFreeCellUnlessCardinal) {
  const Coordinates places = random_coordinates(200, 2, 3);
  const LatticeGrid grid =
      grid_round(places, {7, 6}, GetParam(), GetParam() == LatticeBasis::bernstein ? 0 : 1);
  const Eigen::MatrixXd off = lattice_weights(places, grid) * points_of(grid) - places;
  if (GetParam() == LatticeBasis::cardinal) {
    EXPECT_GT(off.cwiseAbs().maxCoeff(), 1e-3);
  } else {
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Bases, ::testing::ValuesIn(all_bases));

TEST(LatticeWeights, HaveAtMostFourPointsAnAxisAndNoZeros) {
  const LatticeGrid grid = mixed({9, 9}, {LatticeBasis::bspline, LatticeBasis::linear});
  const LatticeWeights w = lattice_weights(random_coordinates(100, 2, 4), grid);
  for (Eigen::Index i = 0; i < w.rows(); ++i) {
    int previous = -1, count = 0;
    for (LatticeWeights::InnerIterator entry(w, i); entry; ++entry, ++count) {
      EXPECT_NE(entry.value(), 0.0);
      EXPECT_GT(entry.col(), previous);
      previous = static_cast<int>(entry.col());
    }
    EXPECT_LE(count, 8);
  }
}

TEST(LatticeWeights, RefuseWhatIsNoGrid) {
  const Coordinates places = random_coordinates(3, 2, 5);
  const LatticeGrid good = mixed({3, 4}, {LatticeBasis::linear, LatticeBasis::linear});
  const auto with = [&](auto change) {
    LatticeGrid grid = good;
    change(grid);
    return grid;
  };
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.count[1] = 0; })), "counts, row 1: 0 is not");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.count[0] = 65; })), "counts, row 0: 65 is not");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.count.push_back(2); })),
                 "points has 2 columns");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.count.clear(); })), "counts has 0 axes");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.basis.pop_back(); })), "kinds has 1 rows");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.spacing[1] = 0.0; })), "spacing, row 1");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.spacing[0] = NAN; })), "spacing, row 0");
  EXPECT_REFUSAL(lattice_weights(places, with([](auto& g) { g.origin[0] = INFINITY; })), "origin, row 0");
  Coordinates bad = places;
  bad(2, 1) = NAN;
  EXPECT_REFUSAL(lattice_weights(bad, good), "points, row 2: not a finite number");
  EXPECT_EQ(lattice_weights(Coordinates(0, 2), good).rows(), 0);
}

}  // namespace
}  // namespace planar::testing
