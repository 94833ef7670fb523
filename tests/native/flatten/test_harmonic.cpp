// SPDX-License-Identifier: GPL-3.0-or-later
#include <vector>

#include "planar/harmonic.h"
#include "support.h"

namespace planar::testing {
namespace {

Eigen::VectorXi vertices(const std::vector<int>& v) {
  return Eigen::Map<const Eigen::VectorXi>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// A strip of n squares, each of two right triangles: vertices 2i below and 2i + 1 above.
Shape strip(int n) {
  Shape shape{Points(2 * n + 2, 2), Triangles(2 * n, 3)};
  for (int i = 0; i <= n; ++i) {
    shape.vertices.row(2 * i) << i, 0.0;
    shape.vertices.row(2 * i + 1) << i, 1.0;
  }
  for (int i = 0; i < n; ++i) {
    shape.triangles.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    shape.triangles.row(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  return shape;
}

TEST(Harmonic, IsLinearBetweenTheEndsOfAStrip) {
  const Shape shape = strip(20);
  const Eigen::VectorXd found = Harmonic(shape.vertices, shape.triangles, vertices({0, 1, 40, 41}))
                                    .spread(Eigen::Vector4d(-1.0, -1.0, 3.0, 3.0));
  const Eigen::VectorXd expected = -1.0 + 4.0 / 20.0 * shape.vertices.col(0).array();
  // The cotangents of diagonals are 0, and count as 1e-9.
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Harmonic, OneValueIsThatOfItsPartAlone) {
  const Shape one = grid(6), shape = joined(one, moved(one, 3.0, 0.0));
  const Eigen::VectorXd found =
      Harmonic(shape.vertices, shape.triangles, vertices({14})).spread(Eigen::VectorXd::Constant(1, 2.5));
  EXPECT_LT((found.head(36).array() - 2.5).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(found.tail(36).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Harmonic, NothingIsBeyondTheValuesHoweverThinTheTriangles) {
  for (const double thickness : {1.0, 1e-2, 1e-4, 1e-8, 0.0}) {
    Shape shape = grid(12, 3);
    shape.vertices.col(1) *= thickness;
    const Eigen::VectorXd found = Harmonic(shape.vertices, shape.triangles, vertices({0, 77, 143}))
                                      .spread(Eigen::Vector3d(-1.0, 4.0, 0.5));
    EXPECT_GE(found.minCoeff(), -1.0 - 1e-9) << thickness;
    EXPECT_LE(found.maxCoeff(), 4.0 + 1e-9) << thickness;
    EXPECT_EQ(found[77], 4.0);
  }
}

TEST(Harmonic, ThereMayBeNothingHeldAndNothingFree) {
  const Shape shape = strip(1);
  EXPECT_EQ(Harmonic(shape.vertices, shape.triangles, {}).spread({}).cwiseAbs().maxCoeff(), 0.0);
  const Eigen::Vector4d all(1.0, 2.0, 3.0, 4.0);
  EXPECT_EQ(Harmonic(shape.vertices, shape.triangles, vertices({0, 1, 2, 3})).spread(all), all);
}

TEST(Harmonic, EachSpreadDependsOnItsOwnValuesAlone) {
  const Shape shape = grid(9);
  const Harmonic kept(shape.vertices, shape.triangles, vertices({0, 40, 80}));
  const Eigen::Vector3d first(1.0, -2.0, 3.0), second(0.5, 0.0, -7.0);
  const Eigen::VectorXd once = kept.spread(first), other = kept.spread(second);
  EXPECT_EQ(kept.spread(first), once);
  EXPECT_LT((kept.spread(first + 2.0 * second) - once - 2.0 * other).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Harmonic, RefusesWhatIsNoMeshOrNoValue) {
  const Shape shape = strip(2);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), two = Eigen::VectorXd::Ones(2);
  EXPECT_REFUSAL(Harmonic(shape.vertices, shape.triangles, vertices({6})).spread(one), "held");
  EXPECT_REFUSAL(Harmonic(shape.vertices, shape.triangles, vertices({-1})).spread(one), "held");
  EXPECT_REFUSAL(Harmonic(shape.vertices, shape.triangles, vertices({1, 1})).spread(two), "twice");
  EXPECT_REFUSAL(Harmonic(shape.vertices, shape.triangles, vertices({1})).spread(two), "values");
  EXPECT_REFUSAL(Harmonic(shape.vertices, shape.triangles, vertices({1})).spread(one / 0.0), "values");
}

}  // namespace
}  // namespace planar::testing
