// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>
#include <vector>

#include "linear/block_kinds.h"
#include "linear/block_solve.h"

namespace planar {
namespace {

using Step = void (*)(const FactorBlock&, double*, int);
using GatheredStep = void (*)(const FactorBlock&, double*);

struct Kind {
  Step forward, backward;
  GatheredStep gathered_forward, gathered_backward;
};

/// Those that this processor can do.
std::vector<Kind> kinds() {
  std::vector<Kind> result{
      {solve_forward, solve_backward, solve_gathered_forward, solve_gathered_backward},
      {solve_forward_any, solve_backward_any, solve_gathered_forward_any, solve_gathered_backward_any}};
#ifdef PLANAR_AVX2
  if (has_avx2()) {
    result.push_back(
        {solve_forward_avx2, solve_backward_avx2, solve_gathered_forward_avx2, solve_gathered_backward_avx2});
  }
#endif
  return result;
}

class EverySolve : public ::testing::TestWithParam<Kind> {};

/// A block of L with rows that lie apart: [own; below]. Forward solves own and takes it out of below,
/// backward solves own with below known.
TEST_P(EverySolve, IsTheStepOfDenseTriangles) {
  for (const int width : {1, 2, 3, 4, 5, 8, 11}) {
    for (const int below : {0, 1, 3, 4, 7, 12}) {
      for (const int columns : {1, 2, 3, 4, 6, 8, 11}) {
        const int height = width + below, first = 2;
        Eigen::MatrixXd block = Eigen::MatrixXd::Random(height, width);
        for (int j = 0; j < width; ++j) {
          block.col(j).head(j).setConstant(1e300);  // not to be read
          block(j, j) = 2.0 + std::abs(block(j, j));
        }
        std::vector<int> row(static_cast<std::size_t>(height));
        std::iota(row.begin(), row.begin() + width, first);
        for (int i = 0; i < below; ++i) row[static_cast<std::size_t>(width + i)] = first + width + 3 * i + 1;
        using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const Rows x = Rows::Random(first + width + 3 * below + 2, columns);
        const auto triangle = block.topRows(width).triangularView<Eigen::Lower>();
        const auto rest = block.bottomRows(below);
        const std::vector<int> own_rows(row.begin(), row.begin() + width),
            rows_below(row.begin() + width, row.end());

        Rows expected = x;
        expected(own_rows, Eigen::all) = triangle.solve(x(own_rows, Eigen::all).eval()).eval();
        expected(rows_below, Eigen::all) -= rest * expected(own_rows, Eigen::all);
        Rows solved = x;
        const FactorBlock factor{block.data(), width, height, row.data()};
        GetParam().forward(factor, solved.data(), columns);
        // Numbers up to 10 and sums of at most 23 products.
        ASSERT_TRUE((solved - expected).isZero(1e-13)) << width << ' ' << below << ' ' << columns;
        Eigen::VectorXd gathered = x(row, 0);
        GetParam().gathered_forward(factor, gathered.data());
        ASSERT_TRUE((gathered - expected(row, 0)).isZero(1e-13)) << width << ' ' << below;

        expected = x;
        const Rows left = x(own_rows, Eigen::all) - rest.transpose() * x(rows_below, Eigen::all);
        expected(own_rows, Eigen::all) = triangle.transpose().solve(left).eval();
        solved = x;
        GetParam().backward(factor, solved.data(), columns);
        ASSERT_TRUE((solved - expected).isZero(1e-13)) << width << ' ' << below << ' ' << columns;
        gathered = x(row, 0);
        GetParam().gathered_backward(factor, gathered.data());
        ASSERT_TRUE((gathered - expected(row, 0)).isZero(1e-13)) << width << ' ' << below;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySolve, ::testing::ValuesIn(kinds()));

}  // namespace
}  // namespace planar
