// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "dense.h"
#include "energy/killing_energy.h"
#include "matrices.h"
#include "support.h"

namespace planar::testing {
namespace {

Eigen::MatrixXd assembled(const Shape& shape, const std::vector<int>& kept,
                          const Eigen::VectorXd& stiffness = {}) {
  const Mesh mesh(shape.vertices.rows(), shape.triangles);
  KillingMatrix matrix(mesh, kept);
  matrix.assemble(shape.vertices, stiffness, std::vector<char>(static_cast<std::size_t>(mesh.n_parts), 1));
  return dense(matrix.matrix());
}

/// Number of fields of no energy, judged where the eigenvalues have a gap.
int null_space(const Eigen::MatrixXd& k) {
  const Eigen::VectorXd values = eigenvalues(k);
  EXPECT_GT(values[0], -1e-10);
  return static_cast<int>((values.array() < 1e-10).count());
}

constexpr double rounding = 1e-12;

TEST(KillingEnergy, IsPTransposedP) {
  const Shape shape = grid(5);
  const Eigen::VectorXd stiffness = random_points(32, 2).col(0).array().abs() + 0.1;
  EXPECT_LT((assembled(shape, all(25)) - dense_k(shape.vertices, shape.triangles)).cwiseAbs().maxCoeff(),
            rounding);
  const Eigen::MatrixXd stiff = dense_k(shape.vertices, shape.triangles, stiffness);
  EXPECT_LT((assembled(shape, all(25), stiffness) - stiff).cwiseAbs().maxCoeff(), rounding);
}

TEST(KillingEnergy, IsTheIntegralOfTheStrainRateSquared) {
  // U = (a x + b y, c x + d y) on a unit square: |J + Jᵀ|² = 4a² + 4d² + 2 (b + c)².
  Shape shape = grid(4);
  for (int i = 0; i < 16; ++i) shape.vertices.row(i) << i % 4 / 3.0, i / 4 / 3.0;
  const double a = 0.3, b = -0.7, c = 0.2, d = 1.1;
  Points u(16, 2);
  u.col(0) = a * shape.vertices.col(0) + b * shape.vertices.col(1);
  u.col(1) = c * shape.vertices.col(0) + d * shape.vertices.col(1);
  EXPECT_NEAR(flat(u).dot(assembled(shape, all(16)) * flat(u)), 4 * a * a + 4 * d * d + 2 * (b + c) * (b + c),
              rounding);
}

TEST(KillingEnergy, HasExactlyTheRigidNullSpacePerPart) {
  const Shape one = grid(5), two = joined(grid(4), moved(grid(3), 2.0, 0.0));
  EXPECT_EQ(null_space(assembled(one, all(25))), 3);
  EXPECT_EQ(null_space(assembled(two, all(25))), 6);
  EXPECT_EQ(null_space(assembled(ring(9), all(18))), 3);
  const Eigen::VectorXd rigid = flat(rigid_field(two.vertices, 1.3, -0.2, 0.5));
  EXPECT_LT((assembled(two, all(25)) * rigid).cwiseAbs().maxCoeff(), rounding);
}

TEST(KillingEnergy, PiecesThatMeetInAVertexAreOneRigidPart) {
  Shape hinge{Points(5, 2), Triangles(2, 3)};
  hinge.vertices << 0, 0, 0, 1, 1, 0.5, 2, 0, 2, 1;
  hinge.triangles << 0, 1, 2, 2, 3, 4;
  EXPECT_EQ(null_space(assembled(hinge, all(5))), 3);
}

TEST(KillingEnergy, FlatTrianglesAreFiniteAndNearlyFreeToMoveRigidly) {
  Shape shape{Points(5, 2), Triangles(3, 3)};
  shape.triangles << 0, 1, 2, 1, 2, 3, 2, 3, 4;
  std::vector<Points> shapes(4, Points(5, 2));
  shapes[0] << 0, 0, 1, 0, 2, 0, 3, 0, 4, 0;  // collinear
  shapes[1] << 0, 0, 1, 0, 2, 1e-6, 3, 0, 4, 1;
  shapes[2] << 0, 0, 1, 0, 1, 0, 3, 0, 4, 1;  // two vertices in one place: a hinge between two flat triangles
  shapes[3].setOnes();                        // all in one place
  for (const Points& x : shapes) {
    shape.vertices = x;
    const Eigen::MatrixXd k = assembled(shape, all(5));
    ASSERT_TRUE(k.allFinite());
    EXPECT_GT(eigenvalues(k)[3], 1e-8);  // the anchor's size
    const Eigen::VectorXd rigid = flat(rigid_field(x, 1.0, 2.0, 3.0));
    EXPECT_LT(rigid.dot(k * rigid), 1e-6 * rigid.squaredNorm());
  }
}

TEST(KillingEnergy, DependsOnNeitherUnitNorOrientation) {
  const Shape shape = grid(4);
  Shape other = shape;
  other.vertices *= 1000.0;
  other.triangles.col(0).swap(other.triangles.col(1));
  EXPECT_LT((assembled(shape, all(16)) - assembled(other, all(16))).cwiseAbs().maxCoeff(), rounding);
}

TEST(KillingEnergy, FollowsTheOrderOfKeptVerticesAndLeavesOthersOut) {
  const Shape shape = grid(5);
  const std::vector<int> kept{12, 7, 18, 3, 0, 13};
  std::vector<int> unknown;
  for (const int v : kept) unknown.insert(unknown.end(), {2 * v, 2 * v + 1});
  const Eigen::MatrixXd k = dense_k(shape.vertices, shape.triangles);
  EXPECT_LT((assembled(shape, kept) - k(unknown, unknown)).cwiseAbs().maxCoeff(), rounding);
}

TEST(KillingEnergy, InactivePartsGetUnitRows) {
  const Shape shape = joined(grid(3), moved(grid(3), 2.0, 0.0));
  const Mesh mesh(18, shape.triangles);
  KillingMatrix matrix(mesh, all(18));
  matrix.assemble(shape.vertices, {}, {0, 1});
  const Eigen::MatrixXd k = dense(matrix.matrix());
  EXPECT_EQ(k.topLeftCorner(18, 18), Eigen::MatrixXd::Identity(18, 18));
  EXPECT_LT((k - dense_k(shape.vertices, shape.triangles)).bottomRightCorner(18, 18).cwiseAbs().maxCoeff(),
            rounding);
}

TEST(KillingEnergy, AddsToBlocksOfHandles) {
  const Shape shape = grid(3);
  const Mesh mesh(9, shape.triangles);
  KillingMatrix matrix(mesh, {4, 8, 0, 1, 2, 3, 5, 6, 7});
  matrix.assemble(shape.vertices, {}, {1});
  const Eigen::MatrixXd before = dense(matrix.matrix());
  matrix.add(4, 4, 2.0);
  matrix.add(5, 4, 3.0);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(18, 18);
  expected.block<2, 2>(0, 0) = 2.0 * Eigen::Matrix2d::Identity();
  expected.block<2, 2>(12, 0) = expected.block<2, 2>(0, 12) = 3.0 * Eigen::Matrix2d::Identity();
  EXPECT_LT((dense(matrix.matrix()) - before - expected).cwiseAbs().maxCoeff(), rounding);
}

}  // namespace
}  // namespace planar::testing
