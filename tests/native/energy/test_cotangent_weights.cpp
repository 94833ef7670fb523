// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "energy/cotangent_weights.h"
#include "support.h"

namespace planar::testing {
namespace {

RestOf in(const Points& x) {
  return [&x](int, int v) -> Eigen::Vector2d { return x.row(v); };
}

/// Two triangles on the edge 01, with these heights above and below its middle, half an edge of 1.
Shape kite(double above, double below) {
  Shape shape{Points(4, 2), Triangles(2, 3)};
  shape.vertices << -1, 0, 1, 0, 0, above, 0, -below;
  shape.triangles << 0, 1, 2, 0, 1, 3;
  return shape;
}

Eigen::VectorXd weights(const Shape& shape, const Eigen::VectorXd& stiffness = {}) {
  return cotangent_weights(Mesh(shape.vertices.rows(), shape.triangles), in(shape.vertices), stiffness);
}

TEST(CotangentWeights, AreThoseOfTheAnglesOppositeToAnEdge) {
  // Angle 2 atan(1/h) opposite to the edge, atan(h) at its ends.
  const double above = 1.5, below = 0.9;
  const Eigen::VectorXd w = weights(kite(above, below));
  const auto cot = [](double angle) { return 1.0 / std::tan(angle); };
  EXPECT_NEAR(w[0], 0.5 * (cot(2.0 * std::atan(1.0 / above)) + cot(2.0 * std::atan(1.0 / below))), 1e-14);
  EXPECT_NEAR(w[1], 0.5 / above, 1e-14);
  EXPECT_NEAR(w[2], 0.5 / below, 1e-14);
}

TEST(CotangentWeights, AreMultipliedWithTheStiffnessOfEachTriangle) {
  const Eigen::VectorXd w = weights(kite(2.0, 3.0), Eigen::Vector2d(5.0, 7.0));
  EXPECT_NEAR(w[1], 5.0 * 0.5 / 2.0, 1e-14);
  EXPECT_NEAR(w[2], 7.0 * 0.5 / 3.0, 1e-14);
  EXPECT_NEAR(w[0], 5.0 * 0.5 * 0.75 + 7.0 * 0.5 * 4.0 / 3.0, 1e-14);
}

TEST(CotangentWeights, AreClampedWhereDelaunaysConditionFails) {
  const Eigen::VectorXd w = weights(kite(0.3, 0.4));
  EXPECT_GT(w[0], 0.0);
  EXPECT_LT(w[0], 1e-8);
}

TEST(CotangentWeights, AreFiniteOnTrianglesWithoutArea) {
  for (const Shape& shape : {kite(0.0, 0.0), kite(1e-300, 1.0)}) {
    const Eigen::VectorXd w = weights(shape);
    EXPECT_TRUE(w.allFinite());
    EXPECT_GT(w.minCoeff(), 0.0);
  }
  Shape point = kite(1.0, 1.0);
  point.vertices.setOnes();
  EXPECT_GT(weights(point).minCoeff(), 0.0);
}

TEST(CotangentWeights, UniformOnesAreTheMeanStiffness) {
  const Shape shape = kite(1.0, 1.0);
  const Mesh mesh(4, shape.triangles);
  EXPECT_EQ(uniform_weights(mesh), Eigen::VectorXd::Ones(5));
  const Eigen::VectorXd w = uniform_weights(mesh, Eigen::Vector2d(1.0, 4.0));
  EXPECT_EQ(w[0], 2.5);
  EXPECT_EQ(w[1], 1.0);
  EXPECT_EQ(w[2], 4.0);
}

}  // namespace
}  // namespace planar::testing
