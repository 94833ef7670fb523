// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "mesh/triangle_shape.h"
#include "support.h"

namespace planar::testing {
namespace {

Flags flat(const Shape& shape) { return flat_triangles(shape.vertices, shape.triangles); }

/// A grid and beside it, in its part, a triangle of this base and altitude, in cells.
Shape with_triangle(double base, double altitude) {
  const Shape good = grid(9);
  const double cell = 0.125;
  Shape shape{Points(83, 2), Triangles(good.triangles.rows() + 1, 3)};
  shape.vertices.topRows(81) = good.vertices;
  const Eigen::RowVector2d corner = good.vertices.row(80);
  shape.vertices.row(81) = corner + cell * Eigen::RowVector2d(base, 0.0);
  shape.vertices.row(82) = corner + cell * Eigen::RowVector2d(0.5 * base, altitude);
  shape.triangles << good.triangles, Eigen::RowVector3i(80, 81, 82);
  return shape;
}

TEST(TriangleShape, FlatIsWhatNobodySees) {
  EXPECT_EQ(flat(grid(9)).count(), 0);
  // By the altitude, and, as small as a thousandth of the others, by the area.
  EXPECT_TRUE(flat(with_triangle(1.0, 3e-4))[128]);
  EXPECT_FALSE(flat(with_triangle(1.0, 3e-3))[128]);
  EXPECT_TRUE(flat(with_triangle(3e-4, 2e-3))[128]);
  EXPECT_FALSE(flat(with_triangle(3e-3, 3e-3))[128]);
  EXPECT_TRUE(flat(with_triangle(0.0, 0.0))[128]);
  EXPECT_EQ(flat(with_triangle(1.0, 0.0)).count(), 1);
}

TEST(TriangleShape, NeitherUnitNorRotationCount) {
  const Shape shape = with_triangle(1.0, 3e-4);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double angle : {0.0, 0.7, 2.0}) {
      const Points x = scale * rigid_motion(shape.vertices, angle, 0.3, -0.2);
      EXPECT_TRUE((flat_triangles(x, shape.triangles) == flat(shape)).all()) << scale << ' ' << angle;
    }
  }
}

TEST(TriangleShape, EachPartIsMeasuredByItself) {
  Shape fine = moved(grid(9, 3), 2.0, 0.0);
  fine.vertices *= 1e-4;
  EXPECT_EQ(flat(joined(grid(33), fine)).count(), 0);
  // A part made of thin triangles alone has no others to be flat beside.
  Shape thin = grid(9);
  thin.vertices.col(1) *= 1e-4;
  EXPECT_EQ(flat(thin).count(), 0);
  EXPECT_EQ(flat(joined(grid(33), moved(thin, 2.0, 0.0))).count(), 0);
  // Nor does one in which most triangles have no area.
  Shape mostly{Points(5, 2), (Triangles(4, 3) << 0, 1, 2, 0, 1, 3, 1, 4, 3, 0, 4, 3).finished()};
  mostly.vertices << 0, 0, 1, 0, 0, 1, 0.5, 0, 0.25, 0;
  EXPECT_TRUE((flat(mostly) == (Flags(4) << false, true, true, true).finished()).all());
}

TEST(TriangleShape, WhatFloat32DoesNotTellIsFlat) {
  const Shape thin = with_triangle(1.0, 3e-3);
  EXPECT_FALSE(flat(thin)[128]);
  EXPECT_TRUE(flat(moved(thin, 1e3, 0.0))[128]) << "3.75e-4 beside coordinates known to 6e-5";
  EXPECT_EQ(flat(moved(thin, 1e3, 0.0)).count(), 1);
  // A whole mesh that far away would have nothing left: it is judged without.
  EXPECT_EQ(flat(moved(grid(9), 1e6, 0.0)).count(), 0);
}

}  // namespace
}  // namespace planar::testing
