// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "planar/distortion.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double rounding = 1e-12;  // closed forms of numbers near 1

Points mapped(const Points& x, const Eigen::Matrix2d& map) { return x * map.transpose(); }

TEST(Distortion, RigidMotionsAreNone) {
  const Shape shape = grid(7);
  const Distortion d =
      distortion(shape.vertices, rigid_motion(shape.vertices, 2.0, 3.0, -1.0), shape.triangles);
  EXPECT_NEAR(d.area, 2.0, rounding);
  EXPECT_NEAR(d.angle, 2.0, rounding);
  EXPECT_EQ(d.flipped, 0);
}

TEST(Distortion, StretchInClosedForm) {
  // Singular values 3 and 1/2: area 3/2 + 2/3, angle 6 + 1/6, for each triangle and so for their mean.
  const Shape shape = grid(7);
  Eigen::Matrix2d stretch =
      Eigen::Rotation2Dd(0.7).toRotationMatrix() * Eigen::Vector2d(3.0, 0.5).asDiagonal();
  stretch *= Eigen::Rotation2Dd(-1.1).toRotationMatrix();
  const Distortion d = distortion(shape.vertices, mapped(shape.vertices, stretch), shape.triangles);
  EXPECT_NEAR(d.area, 1.5 + 1.0 / 1.5, rounding);
  EXPECT_NEAR(d.angle, 6.0 + 1.0 / 6.0, rounding);
  EXPECT_NEAR(d.triangle_area.minCoeff(), d.triangle_area.maxCoeff(), rounding);
}

TEST(Distortion, MeansAreByRestArea) {
  Shape shape{Points(6, 2), Triangles(2, 3)};
  shape.vertices << 0, 0, 1, 0, 0, 1, 5, 0, 8, 0, 5, 1;  // areas 1/2 and 3/2
  shape.triangles << 0, 1, 2, 3, 4, 5;
  Points posed = shape.vertices;
  posed.bottomRows(3).col(1) *= 2.0;  // area term 2 + 1/2, angle the same
  const Distortion d = distortion(shape.vertices, posed, shape.triangles);
  EXPECT_NEAR(d.area, 0.25 * 2.0 + 0.75 * 2.5, rounding);
  EXPECT_NEAR(d.angle, 0.25 * 2.0 + 0.75 * 2.5, rounding);
}

TEST(Distortion, FlipsAreRelativeToRest) {
  const Shape shape = grid(4);  // alternate triangles are turned round already
  Eigen::Matrix2d mirror = Eigen::Vector2d(-1.0, 1.0).asDiagonal();
  const Distortion d = distortion(shape.vertices, mapped(shape.vertices, mirror), shape.triangles);
  EXPECT_EQ(d.flipped, shape.triangles.rows());
  EXPECT_NEAR(d.area, 2.0, rounding);
}

TEST(Distortion, FlipsAreJudgedInFloat32) {
  Points rest(3, 2), posed(3, 2);
  rest << 0, 0, 1, 0, 0.5, 1;
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  // The third vertex is a little above the line between the others, but float32 puts it below.
  posed << 100, 1, 101, 1 + 1.04e-6, 100.5, 1 + 5.3e-7;
  const auto rounded = [](double value) { return static_cast<double>(static_cast<float>(value)); };
  const double line = (rounded(posed(0, 1)) + rounded(posed(1, 1))) / 2.0;
  ASSERT_GT(posed(2, 1), (posed(0, 1) + posed(1, 1)) / 2.0);
  ASSERT_LT(rounded(posed(2, 1)), line);
  EXPECT_EQ(distortion(rest, posed, triangle).flipped, 1);
  EXPECT_TRUE(distortion(rest, posed, triangle).triangle_flipped[0]);
}

TEST(Distortion, CollapsedTrianglesAreInfinite) {
  const Shape shape = grid(3);
  const Distortion d = distortion(shape.vertices, Points::Zero(9, 2), shape.triangles);
  EXPECT_TRUE(std::isinf(d.area) && std::isinf(d.angle));
  EXPECT_EQ(d.flipped, 0);
}

TEST(Distortion, TrianglesWithoutRestAreaDoNotCount) {
  Points rest(4, 2);
  rest << 0, 0, 1, 0, 0, 1, 2, 0;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 1, 3;
  const Distortion d = distortion(rest, random_points(4, 5), triangles);
  EXPECT_EQ(d.triangle_area[1], 2.0);
  EXPECT_EQ(d.triangle_angle[1], 2.0);
  EXPECT_EQ(d.area, d.triangle_area[0]);
}

TEST(Distortion, CollinearTrianglesDoNotCountWhereverTheyAre) {
  // In double, some of these have an area of 1e-17 at rest, and then a Jacobian of anything.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> value(-10.0, 10.0);
  for (int i = 0; i < 2000; ++i) {
    Shape shape = grid(4, static_cast<unsigned>(i));
    shape.vertices.row(5) = 0.5 * (shape.vertices.row(4) + shape.vertices.row(8));
    shape.triangles.row(6) << 4, 5, 8;
    shape = moved(shape, value(random), value(random));
    Points posed = rigid_motion(shape.vertices, value(random), 0.1, 0.2);
    posed.row(5) += Eigen::RowVector2d(1e-3, 1e-3);
    const Distortion d = distortion(shape.vertices, posed, shape.triangles);
    ASSERT_EQ(d.triangle_area[6], 2.0) << i;
    ASSERT_EQ(d.triangle_angle[6], 2.0) << i;
    ASSERT_FALSE(d.triangle_flipped[6]) << i;
    ASSERT_LT(d.area + d.angle, 4.1) << i;
  }
}

TEST(Distortion, RefusesMismatchedInput) {
  const Shape shape = grid(3);
  EXPECT_THROW(distortion(shape.vertices, Points(8, 2), shape.triangles), std::invalid_argument);
  EXPECT_THROW(distortion(shape.vertices, Points::Constant(9, 2, NAN), shape.triangles),
               std::invalid_argument);
  EXPECT_THROW(distortion({}, {}, {}), std::invalid_argument);
}

/// Where it would overflow, which gave numbers that are none.
TEST(Distortion, RefusesWhatFloat32DoesNotHold) {
  const Shape shape = grid(3);
  const Points huge = 1e154 * shape.vertices;
  EXPECT_REFUSAL(distortion(huge, huge, shape.triangles), "rest, row 0: beyond");
  EXPECT_REFUSAL(distortion(shape.vertices, huge, shape.triangles), "posed, row 0: beyond");
  // Too small for it, they are triangles without area.
  EXPECT_EQ(distortion(1e-154 * shape.vertices, shape.vertices, shape.triangles).area, 2.0);
  for (const double size : {1e-36, 1e37}) {
    const Points other = size * shape.vertices;
    EXPECT_NEAR(distortion(other, other, shape.triangles).area, 2.0, 1e-12);
    EXPECT_NEAR(distortion(shape.vertices, other, shape.triangles).angle, 2.0, 1e-12);
  }
}

}  // namespace
}  // namespace planar::testing
