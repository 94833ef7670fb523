// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "linear/block_kinds.h"
#include "linear/block_panel.h"

namespace planar {
namespace {

using Factor = bool (*)(const FactorPanel&, const double*, std::ptrdiff_t);

/// Those that this processor can do.
std::vector<Factor> kinds() {
  std::vector<Factor> result{factor_panel, factor_panel_any};
#ifdef PLANAR_AVX2
  if (has_avx2()) result.push_back(factor_panel_avx2);
#endif
  return result;
}

class EveryPanel : public ::testing::TestWithParam<Factor> {};

/// The first four columns of LLᵀ, of which `earlier` is to be taken off, with what is above the diagonal not
/// to be read.
TEST_P(EveryPanel, IsTheFactorOfTheDenseMatrix) {
  for (const int height : {4, 5, 6, 7, 8, 9, 11, 12, 19}) {
    const int stride = height + 2, stride_earlier = height + 5;
    Eigen::MatrixXd factor = Eigen::MatrixXd::Random(height, 4);
    for (int j = 0; j < 4; ++j) {
      factor.col(j).head(j).setZero();
      factor(j, j) = 1.0 + std::abs(factor(j, j));
    }
    Eigen::MatrixXd earlier = Eigen::MatrixXd::Random(stride_earlier, 4);
    Eigen::MatrixXd panel = Eigen::MatrixXd::Constant(stride, 4, 7.0);
    panel.topRows(height) = factor * factor.topRows(4).transpose() + earlier.topRows(height);
    for (int j = 0; j < 4; ++j) {
      panel.col(j).head(j).setConstant(1e300);
      earlier.col(j).head(j).setConstant(1e300);
    }
    ASSERT_TRUE(GetParam()({panel.data(), stride, height}, earlier.data(), stride_earlier));
    for (int j = 0; j < 4; ++j) {
      for (int i = j; i < height; ++i) ASSERT_NEAR(panel(i, j), factor(i, j), 1e-13) << height;
      for (int i = 0; i < j; ++i) ASSERT_EQ(panel(i, j), 1e300) << height;
      for (int i = height; i < stride; ++i) ASSERT_EQ(panel(i, j), 7.0) << height;
    }
  }
}

TEST_P(EveryPanel, RefusesPivotsThatAreNotPositive) {
  const Eigen::Matrix4d none = Eigen::Matrix4d::Zero();
  for (int bad = 0; bad < 4; ++bad) {
    for (const double pivot : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
      Eigen::Matrix4d panel = Eigen::Matrix4d::Identity();
      panel(bad, bad) = pivot;
      ASSERT_FALSE(GetParam()({panel.data(), 4, 4}, none.data(), 4)) << bad << ' ' << pivot;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryPanel, ::testing::ValuesIn(kinds()));

}  // namespace
}  // namespace planar
