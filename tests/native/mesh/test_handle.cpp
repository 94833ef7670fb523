// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "planar/handle.h"
#include "support.h"

namespace planar::testing {
namespace {

TEST(Handles, AtVerticesAreWhereTheVerticesAre) {
  const Shape shape = grid(4);
  const Points positions = at(shape, {3, 0, 9}).positions(shape.vertices);
  EXPECT_EQ(positions.row(0), shape.vertices.row(3));
  EXPECT_EQ(positions.row(2), shape.vertices.row(9));
}

TEST(Handles, InTrianglesAreBarycentricMeans) {
  const Shape shape = grid(4);
  const Points positions = inside(shape, {5}).positions(shape.vertices);
  const auto corner = [&](int c) { return shape.vertices.row(shape.triangles(5, c)); };
  const Eigen::RowVector2d expected = 0.2 * corner(0) + 0.3 * corner(1) + 0.5 * corner(2);
  EXPECT_LT((positions.row(0) - expected).norm(), 1e-15);
}

TEST(Handles, FloatWeightsAreMadeToSumToOne) {
  const Shape shape = grid(3);
  const Handles handles =
      inside(shape, {0}, static_cast<double>(0.3333333F), static_cast<double>(0.3333334F) + 4e-7);
  EXPECT_NEAR(handles.weights.row(0).sum(), 1.0, 1e-15);
}

TEST(Handles, RefusalsNameTheRow) {
  const Shape shape = grid(3);
  EXPECT_REFUSAL(at(shape, {0, 9}), "handles, row 1: vertex 9 is out of range");
  EXPECT_REFUSAL(at(shape, {-1}), "row 0: vertex -1");
  EXPECT_REFUSAL(inside(shape, {0, 8}), "handles, row 1: triangle 8 is out of range");
  EXPECT_REFUSAL(inside(shape, {2}, 1.2, 0.3), "barycentric, row 0");
  EXPECT_REFUSAL(inside(shape, {2}, NAN, 0.3), "barycentric, row 0");
  EXPECT_REFUSAL(Handles::in_triangles(Eigen::VectorXi::Zero(2),
                                       Eigen::Matrix<double, 1, 3>::Constant(1.0 / 3.0), shape.triangles, 9),
                 "barycentric has 1 rows, expected 2");
}

}  // namespace
}  // namespace planar::testing
