// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "cutout/delaunay.h"
#include "mesh/triangle_shape.h"

namespace planar::testing {
namespace {

Points square(double low, double high) {
  Points points(4, 2);
  points << low, low, high, low, high, high, low, high;
  return points;
}

Points joined(const std::vector<Points>& all) {
  Points points(0, 2);
  for (const Points& one : all) {
    points.conservativeResize(points.rows() + one.rows(), 2);
    points.bottomRows(one.rows()) = one;
  }
  return points;
}

double area(const Points& points, const Triangles& triangles) {
  double doubled = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double one = doubled_area(points, triangles.data() + 3 * t);
    EXPECT_GT(one, 0.0);
    doubled += one;
  }
  return 0.5 * doubled;
}

TEST(Delaunay, FillsWhatAnOddNumberOfRingsEncloses) {
  const Points points = joined({square(0, 10), square(2, 8), square(4, 6)});
  EXPECT_DOUBLE_EQ(area(points, constrained_delaunay(points, {4, 4, 4})), 100.0 - 36.0 + 4.0);
  EXPECT_DOUBLE_EQ(area(points, constrained_delaunay(points, {4})), 100.0);
}

TEST(Delaunay, NoPointIsInACircleOfAnother) {
  Points points = joined({square(0, 10), Points(1, 2)});
  points.row(4) << 5.0, 1.0;
  EXPECT_EQ(constrained_delaunay(points, {4}).rows(), 4);
}

TEST(Delaunay, PointsInOnePlaceAndOnOneLine) {
  Points points = joined({square(0, 10), square(0, 10).topRows(1), Points::Constant(2, 2, 5.0)});
  const Triangles triangles = constrained_delaunay(points, {4});
  EXPECT_DOUBLE_EQ(area(points, triangles), 100.0);
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    EXPECT_NE(triangles.data()[i], 4);
    EXPECT_NE(triangles.data()[i], 6);
  }
  Points line(3, 2);
  line << 0, 0, 1, 1, 2, 2;
  EXPECT_EQ(constrained_delaunay(line, {}).rows(), 0);
  EXPECT_EQ(constrained_delaunay(Points(0, 2), {}).rows(), 0);
}

TEST(Delaunay, RingsThatCrossAreAnError) {
  const Points points = joined({square(0, 10), square(5, 15)});
  EXPECT_THROW(constrained_delaunay(points, {4, 4}), SolveError);
}

}  // namespace
}  // namespace planar::testing
