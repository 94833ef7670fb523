// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "linear/block_kinds.h"
#include "linear/block_product.h"

namespace planar {
namespace {

using Product = void (*)(const double*, int, int, int, std::ptrdiff_t, double*);

/// Those that this processor can do.
std::vector<Product> kinds() {
  std::vector<Product> result{lower_product, lower_product_any};
#ifdef PLANAR_AVX2
  if (has_avx2()) result.push_back(lower_product_avx2);
#endif
  return result;
}

class EveryProduct : public ::testing::TestWithParam<Product> {};

TEST_P(EveryProduct, IsTheLowerPartOfTheDenseProduct) {
  for (const int m : {1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 40}) {
    for (const int n : {1, 2, 3, 4, 5, 8, 11, 17}) {
      for (const int k : {0, 1, 2, 5, 33}) {
        if (n > m) continue;
        const int stride = m + 3, skipped = 2;
        const Eigen::MatrixXd whole = Eigen::MatrixXd::Random(stride, k);
        std::vector<double> values(whole.data(), whole.data() + whole.size());
        values.resize(values.size() + tile_overhang, 1e300);
        const std::ptrdiff_t stride_c = product_stride(m);
        Eigen::MatrixXd c = Eigen::MatrixXd::Constant(stride_c, n + tile_columns - 1, 7.0);
        GetParam()(values.data() + skipped, m, n, k, stride, c.data());
        const Eigen::MatrixXd a = whole.middleRows(skipped, m);
        const Eigen::MatrixXd expected = a * a.topRows(n).transpose();
        for (int j = 0; j < n; ++j) {
          // Sums of at most 33 products below 1.
          for (int i = j; i < m; ++i) ASSERT_NEAR(c(i, j), expected(i, j), 1e-14) << m << n << k;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryProduct, ::testing::ValuesIn(kinds()));

}  // namespace
}  // namespace planar
