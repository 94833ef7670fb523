// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "dense.h"
#include "lattice/held_samples.h"
#include "lattice/held_system.h"
#include "lattice/lattice_support.h"
#include "mesh/triangle_shape.h"

namespace planar::testing {
namespace {

Eigen::Matrix4d matrix_of(const Jacobian& j) {
  const auto form = j.form();
  Eigen::Matrix4d result;
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < 4; ++l) result(k, l) = form[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)];
  }
  return result;
}

Eigen::Vector4d slope_of(const std::array<double, 4>& entry) {
  const auto slope = Jacobian{entry}.slope();
  return Eigen::Map<const Eigen::Vector4d>(slope.data());
}

/// Random ones with det J > 0.
std::vector<Jacobian> jacobians(int count) {
  std::vector<Jacobian> result;
  for (unsigned seed = 1; static_cast<int>(result.size()) < count; ++seed) {
    const Coordinates c = 1.5 * random_coordinates(1, 4, seed);
    const Jacobian j{{c(0, 0), c(0, 1), c(0, 2), c(0, 3)}};
    if (j.delta() > 0.05) result.push_back(j);
  }
  return result;
}

TEST(Jacobian, ValueIsThatOfItAndItsInverse) {
  for (const Jacobian& j : jacobians(20)) {
    Eigen::Matrix2d m;
    m << j.entry[0], j.entry[1], j.entry[2], j.entry[3];
    EXPECT_NEAR(j.value(), m.squaredNorm() + m.inverse().squaredNorm() - 4.0, 1e-9 * (j.value() + 4.0));
  }
  EXPECT_TRUE(std::isinf(Jacobian({{1.0, 0.0, 0.0, -1.0}}).value()));
  EXPECT_NEAR(Jacobian({{0.6, -0.8, 0.8, 0.6}}).value(), 0.0, 1e-15);
}

TEST(Jacobian, SlopeIsThatOfDifferences) {
  for (const Jacobian& j : jacobians(20)) {
    const Eigen::Vector4d slope = slope_of(j.entry);
    for (std::size_t k = 0; k < 4; ++k) {
      auto after = j.entry, before = j.entry;
      after[k] += 1e-6;
      before[k] -= 1e-6;
      EXPECT_NEAR(slope[static_cast<Eigen::Index>(k)],
                  (Jacobian{after}.value() - Jacobian{before}.value()) / 2e-6, 1e-6 * slope.norm());
    }
  }
}

/// METHODS: H without its negative eigenvalue, of which there is one at most, along the twist.
TEST(Jacobian, FormIsTheHessianOfDifferencesWithoutItsNegativeEigenvalue) {
  int negative = 0;
  for (const Jacobian& j : jacobians(200)) {
    Eigen::Matrix4d h;
    for (std::size_t k = 0; k < 4; ++k) {
      auto after = j.entry, before = j.entry;
      after[k] += 1e-6;
      before[k] -= 1e-6;
      h.col(static_cast<Eigen::Index>(k)) = (slope_of(after) - slope_of(before)) / 2e-6;
    }
    h = (0.5 * (h + h.transpose())).eval();
    const Eigen::VectorXd values = eigenvalues(h);
    negative += values[0] < 0.0;
    EXPECT_GT(values[1], 0.0);
    EXPECT_LT((matrix_of(j) - positive_part(h)).norm(), 1e-6 * values[3]);
  }
  EXPECT_GT(negative, 20);  // else nothing was tested
}

struct Held {
  Held() : in(grid(9), {6, 5}), shape(in.shape.vertices, in.shape.triangles, flat()) {}
  Flags flat() const { return flat_triangles(in.shape.vertices, in.shape.triangles); }

  InLattice in;
  HeldShape shape;
};

TEST(HeldShape, IsZeroForRigidMotions) {
  const Held held;
  const Points u = rigid_motion(held.in.shape.vertices, 2.0, 3.0, -1.0) - held.in.shape.vertices;
  Points g;
  EXPECT_NEAR(held.shape.gradient(u, g), 0.0, 1e-13);
  EXPECT_LT(g.cwiseAbs().maxCoeff(), 1e-13);
}

TEST(HeldShape, GradientIsThatOfDifferences) {
  const Held held;
  const Points u = 0.01 * random_points(held.in.shape.vertices.rows(), 7);
  Points g;
  EXPECT_EQ(held.shape.gradient(u, g), held.shape.value(u));
  for (Eigen::Index i = 0; i < u.size(); i += 7) {
    Points after = u, before = u;
    after.data()[i] += 1e-6;
    before.data()[i] -= 1e-6;
    EXPECT_NEAR(g.data()[i], (held.shape.value(after) - held.shape.value(before)) / 2e-6, 1e-7);
  }
}

TEST(HeldShape, CollapseIsWhereTheFirstTriangleHasNoArea) {
  const Held held;
  const Points u = 0.01 * random_points(held.in.shape.vertices.rows(), 7);
  const Points du = random_points(held.in.shape.vertices.rows(), 8);
  const HeldShape::Collapse first = held.shape.first_collapse(u, du);
  ASSERT_GE(first.triangle, 0);
  EXPECT_TRUE(held.shape.is_upright(u + 0.999 * first.t * du));
  EXPECT_FALSE(held.shape.is_upright(u + 1.001 * first.t * du));
  EXPECT_TRUE(std::isinf(held.shape.first_collapse(u, Points::Zero(u.rows(), 2)).t));
}

TEST(HeldSamples, OfAllTrianglesAreTheWholeEnergy) {
  const Held held;
  HeldSamples samples(held.in.weights);
  for (std::size_t t = 0; t < held.shape.triangles().size(); ++t) {
    samples.add(held.shape.triangles()[t], static_cast<int>(t), held.shape.triangles()[t].area);
  }
  const Points d = 0.03 * random_points(held.in.lattice_rest.rows(), 9);
  const Points u = held.in.weights * d;
  Points vertex_gradient, sampled = Points::Zero(d.rows(), 2);
  const double value = held.shape.gradient(u, vertex_gradient);
  EXPECT_NEAR(samples.value(d, &sampled), value, 1e-12);
  EXPECT_LT((sampled - held.in.weights.transpose() * vertex_gradient).cwiseAbs().maxCoeff(), 1e-12);
}

/// With a sub-cell for each triangle the system is the Hessian by d, up to what projection takes: at a shape
/// that is stretched everywhere, nothing.
TEST(HeldSystem, SolvesWithTheHessianOfDifferences) {
  const Held held;
  const InLattice& in = held.in;
  const auto n = static_cast<Eigen::Index>(held.shape.triangles().size());
  InSteps places = InSteps::Zero(n, 3);
  places.col(0) = Eigen::VectorXd::LinSpaced(n, 0.5, static_cast<double>(n) - 0.5);
  HeldSystem system(in.weights, held.shape, SubCells(places, Eigen::VectorXd::Ones(n), 1),
                    second_differences({6, 5, 1}), 1e-3);
  LatticeSprings<2> springs(in.lattice_rest.rows());
  springs.rows = in.weights.topRows(3);
  springs.rest = in.shape.vertices.topRows(3);
  springs.targets = springs.rest.array() + 0.2;
  springs.weight = Eigen::Vector3d(10.0, 20.0, 30.0);
  springs.points = {4};
  springs.point_rest = in.lattice_rest.row(4);
  springs.point_targets = springs.point_rest.array() - 0.1;
  springs.point_weight = 7.0;
  springs.is_point[4] = 1;
  system.compile(springs);

  const double weight = 1.7;
  const auto energy = [&](const Points& d, Points* gradient) {
    const Points u = in.weights * d;
    Points g;
    const double value = weight * held.shape.gradient(u, g);
    if (gradient != nullptr) *gradient = weight * (in.weights.transpose() * g);
    return value + system.smoothness(d, gradient) + springs.value(d, gradient);
  };
  const Points d = 0.5 * in.lattice_rest + 0.02 * random_points(in.lattice_rest.rows(), 3);
  Points g;
  energy(d, &g);
  for (Eigen::Index i = 0; i < d.size(); i += 3) {
    Points after = d, before = d;
    after.data()[i] += 1e-6;
    before.data()[i] -= 1e-6;
    EXPECT_NEAR(g.data()[i], (energy(after, nullptr) - energy(before, nullptr)) / 2e-6, 1e-6);
  }
  Points step;
  system.factorize(in.weights * d, weight);
  system.solve(g, step);
  // H step = -g, H step by differences.
  Points ahead, behind;
  const double h = 1e-5;
  energy(d + h * step, &ahead);
  energy(d - h * step, &behind);
  EXPECT_LT(((ahead - behind) / (2.0 * h) + g).cwiseAbs().maxCoeff(), 1e-6 * g.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace planar::testing
