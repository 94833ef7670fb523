// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

#include "flatten/patch.h"
#include "flatten/surfaces.h"
#include "mesh/triangle_shape.h"
#include "planar/flatten.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double pi = std::numbers::pi;

FlattenOptions two_steps() {
  FlattenOptions options;
  options.method = FlattenMethod::two_steps;
  return options;
}

Surface cylinder() {
  return sheet(19, 11, 4.0, 2.0, [](double u, double v) {
    return Eigen::RowVector3d(std::cos(u), std::sin(u), v);  // seen from outside, u runs to the right
  });
}

// A cone's side at distances from 1 to 3 from its tip, unrolled: a piece of a ring.
Points unrolled_cone() {
  Points x = unrolled_sheet(17, 9, 2.5, 2.0);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    x.row(v) = (1.0 + x(v, 1)) * Eigen::RowVector2d(-std::cos(x(v, 0)), std::sin(x(v, 0))).eval();
  }
  return x;
}

Surface cone() {
  return sheet(17, 9, 2.5, 2.0, [](double u, double v) -> Eigen::RowVector3d {
    const double along = 1.0 + v, slope = 0.5;  // the tip's angle leaves half of a turn's length
    return along * Eigen::RowVector3d(slope * std::cos(u / slope), slope * std::sin(u / slope),
                                      std::sqrt(1.0 - slope * slope));
  });
}

double length_between(const SpacePoints& x, int a, int b) { return (x.row(a) - x.row(b)).norm(); }

TEST(Flatten, UnrollsCylindersInTwoSteps) {
  const Surface surface = cylinder();
  // What can be unrolled are the triangles, whose sides are chords.
  const double width = 18.0 * 2.0 * std::sin(4.0 / 18.0 / 2.0);
  for (const ArapWeights weights : {ArapWeights::cotangent, ArapWeights::uniform}) {
    FlattenOptions options = two_steps();
    options.weights = weights;
    EXPECT_LT(
        apart(unrolled_sheet(19, 11, width, 2.0), flatten(surface.vertices, surface.triangles, options)),
        1e-6);
  }
  EXPECT_LT(apart(unrolled_sheet(19, 11, width, 2.0), flatten(surface.vertices, surface.triangles)), 1e-6);
}

TEST(Flatten, UnrollsConesInTwoSteps) {
  const Surface surface = cone();
  for (const FlattenMethod method : {FlattenMethod::two_steps, FlattenMethod::hold}) {
    FlattenOptions options;
    options.method = method;
    const Points x = flatten(surface.vertices, surface.triangles, options);
    const Flatness found = flatness(surface, x);
    EXPECT_EQ(found.flipped, 0);
    EXPECT_NEAR(found.area, 2.0, 1e-9);
    EXPECT_NEAR(found.angle, 2.0, 1e-9);
    for (const int v : {3, 60, 150}) {
      EXPECT_NEAR((x.row(v) - x.row(v + 1)).norm(), length_between(surface.vertices, v, v + 1), 1e-6);
    }
  }
  // The smooth cone, but for the chords.
  EXPECT_LT(apart(unrolled_cone(), flatten(surface.vertices, surface.triangles)), 0.02);
}

TEST(Flatten, HoldDistortsLessThanTheTwoSteps) {
  const Surface surface = cap(12, pi / 2.0);
  const Flatness hold = flatness(surface, flatten(surface.vertices, surface.triangles));
  const Flatness two = flatness(surface, flatten(surface.vertices, surface.triangles, two_steps()));
  EXPECT_EQ(hold.flipped, 0);
  EXPECT_LT(hold.area + hold.angle, two.area + two.angle);
}

// Of a flat shape scaled by s, Σ A (|J|² + |J⁻¹|²) is least at s = 1.
TEST(Flatten, HasItsScaleFromTheLeastDistortion) {
  const Surface surface = cap(10, pi / 2.0);
  const Points x = flatten(surface.vertices, surface.triangles);
  const auto energy = [&](double scale) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
      const auto row = surface.triangles.row(t);
      const Eigen::RowVector3d u = surface.vertices.row(row[1]) - surface.vertices.row(row[0]);
      const Eigen::RowVector3d v = surface.vertices.row(row[2]) - surface.vertices.row(row[0]);
      const double area = 0.5 * u.cross(v).norm();
      const double now = 0.5 * scale * scale * doubled_area(x, surface.triangles.data() + 3 * t);
      double square = 0.0;  // |J|² A, by the cotangents
      for (int c = 0; c < 3; ++c) {
        const int a = row[(c + 1) % 3], b = row[(c + 2) % 3];
        const Eigen::RowVector3d p = surface.vertices.row(a) - surface.vertices.row(row[c]);
        const Eigen::RowVector3d q = surface.vertices.row(b) - surface.vertices.row(row[c]);
        square += 0.5 * p.dot(q) / p.cross(q).norm() * scale * scale * (x.row(a) - x.row(b)).squaredNorm();
      }
      sum += square + square * (area / now) * (area / now);
    }
    return sum;
  };
  EXPECT_LT(energy(1.0), energy(0.999));
  EXPECT_LT(energy(1.0), energy(1.001));
}

TEST(Flatten, LiesCounterClockwiseAsSeenFromOutside) {
  const Surface surface = cylinder();
  const Points x = flatten(surface.vertices, surface.triangles);
  EXPECT_GT(doubled_area(x, surface.triangles.data()), 0.0);
  Triangles inward = surface.triangles;
  inward.col(1).swap(inward.col(2));
  EXPECT_GT(doubled_area(flatten(surface.vertices, inward), inward.data()), 0.0);
}

TEST(Flatten, TurnsRoundTrianglesThatDisagreeWithMost) {
  const Surface surface = cap(6, 1.0);
  const Points x = flatten(surface.vertices, surface.triangles);
  Triangles mixed = surface.triangles;
  for (Eigen::Index t = 0; t < mixed.rows(); t += 3) std::swap(mixed(t, 0), mixed(t, 1));
  EXPECT_LT(apart(x, flatten(surface.vertices, mixed)), 1e-4);
  EXPECT_GT(doubled_area(flatten(surface.vertices, mixed), mixed.data() + 3), 0.0);
}

TEST(Flatten, LiesAlongTheXAxisAboutTheOrigin) {
  const Surface surface = cylinder();
  const Points x = flatten(surface.vertices, surface.triangles);
  EXPECT_LT(x.colwise().mean().norm(), 0.05);
  EXPECT_LT(std::abs(x(18, 1) - x(0, 1)), 1e-9);
  const double width = x.col(0).maxCoeff() - x.col(0).minCoeff();
  EXPECT_NEAR(width, 18.0 * 2.0 * std::sin(1.0 / 9.0), 1e-9);
}

TEST(Flatten, HasTheFixedEdgeAlongTheXAxis) {
  const Surface surface = cylinder();
  FlattenOptions options;
  options.fixed = {19, 0};  // an edge up the side of the cylinder
  for (const FlattenMethod method : {FlattenMethod::two_steps, FlattenMethod::hold}) {
    options.method = method;
    const Points x = flatten(surface.vertices, surface.triangles, options);
    EXPECT_NEAR(x(0, 0) - x(19, 0), 0.2, 1e-9);
    EXPECT_NEAR(x(0, 1) - x(19, 1), 0.0, 1e-9);
  }
}

TEST(Flatten, TakesHoles) {
  // Two holes, one of them where the two steps turn triangles over.
  Surface surface = cap(9, 2.4);
  surface = without(surface, [](int t) { return t < 6 || (t > 130 && t < 134); });
  const Patch patch(surface.vertices, surface.triangles);
  ASSERT_EQ(patch.loops.size(), 3);
  const Flatness found = flatness(surface, flatten(surface.vertices, surface.triangles));
  EXPECT_EQ(found.flipped, 0);
  EXPECT_LT(found.area, 2.3);
}

TEST(Flatten, OpensATubeAsARing) {
  const Surface whole = sleeve(12, 6);
  const int tip = static_cast<int>(whole.vertices.rows()) - 1;
  const Surface tube = without(whole, [&](int t) { return (whole.triangles.row(t).array() == tip).any(); });
  const Points x = flatten(tube.vertices, tube.triangles);
  EXPECT_EQ(flatness(tube, x).flipped, 0);
  EXPECT_GT(flatness(tube, x).area, 2.01);
}

TEST(Flatten, ASingleTriangleAndAPair) {
  SpacePoints vertices(4, 3);
  vertices << 0, 0, 0, 3, 0, 0, 0, 4, 0, 3, 4, 5;
  Triangles one(1, 3), two(2, 3);
  one << 0, 1, 2;
  two << 0, 1, 2, 1, 3, 2;
  for (const Triangles* given : {&one, &two}) {
    const Triangles& triangles = *given;
    const Points x = flatten(vertices, triangles);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int c = 0; c < 3; ++c) {
        const int a = triangles(t, c), b = triangles(t, (c + 1) % 3);
        EXPECT_NEAR((x.row(a) - x.row(b)).norm(), length_between(vertices, a, b), 1e-6);
      }
    }
    if (triangles.rows() == 1) {
      EXPECT_EQ(x.row(3), Eigen::RowVector2d(0.0, 0.0));  // of no triangle
    }
  }
}

/// Rugged height fields, caps of up to 300°, caps with holes, and strips of slivers.
Surface random_patch(int number, std::mt19937& random) {
  const auto between = [&random](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  if (number % 4 == 0) {
    std::array<double, 12> a;
    for (double& value : a) value = between(-1.0, 1.0);
    const double height = between(0.03, 1.0), rugged = between(0.0, 0.15);
    Surface surface =
        sheet(8 + number % 5, 6 + number % 7, 1.0, 1.0, [&](double u, double v) -> Eigen::RowVector3d {
          double z = 0.0;
          for (std::size_t k = 0; k < 4; ++k) {
            z += a[3 * k] * std::sin(3.0 * u * a[3 * k + 1] * static_cast<double>(k + 1) +
                                     3.0 * v * a[3 * k + 2] * static_cast<double>(k + 2));
          }
          return {u, v, height * z};
        });
    for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v)
      surface.vertices(v, 2) += between(-rugged, rugged);
    return surface;
  }
  if (number % 4 == 3) {
    const double thin = std::pow(10.0, between(-9.0, -1.0));
    return sheet(11, 6, 2.0, 1.0, [thin](double u, double v) -> Eigen::RowVector3d {
      const double x = u < 1.0 ? u : u < 1.2 ? 1.0 + (u - 1.0) * thin : u - 0.2;
      return {x, v + 0.3 * std::sin(3.0 * x), 0.4 * std::sin(5.0 * x) * std::cos(4.0 * v)};
    });
  }
  const int rings = 3 + number % 5;
  Surface surface = cap(rings, between(0.4, 5.0 / 6.0 * pi));
  if (number % 4 == 1) {
    // A slit from the boundary towards the pole.
    std::vector<int> path;
    const int last = 1 + static_cast<int>(between(0.0, rings - 1.0));
    for (int ring = rings; ring >= last; --ring) path.push_back(1 + 3 * ring * (ring - 1));
    return path.size() > 1 ? cut(surface, path) : surface;
  }
  std::vector<char> touched(static_cast<std::size_t>(surface.vertices.rows()));
  const int boundary = 1 + 3 * rings * (rings - 1);
  const double holes = between(0.0, 0.25);
  surface = without(surface, [&](int t) {
    for (int c = 0; c < 3; ++c) {
      const int v = surface.triangles(t, c);
      if (v >= boundary || touched[static_cast<std::size_t>(v)]) return false;
    }
    if (between(0.0, 1.0) > holes) return false;
    for (int c = 0; c < 3; ++c) touched[static_cast<std::size_t>(surface.triangles(t, c))] = 1;
    return true;
  });
  for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v) surface.vertices.row(v) *= between(0.9, 1.1);
  return surface;
}

TEST(Flatten, TurnsNoTriangleOverInRandomPatches) {
  std::mt19937 random(7);
  for (int number = 0; number < 500; ++number) {
    SCOPED_TRACE("patch " + std::to_string(number));
    const Surface surface = random_patch(number, random);
    const Flattener flattener(surface.vertices, surface.triangles);
    EXPECT_EQ(flattener.report().flipped, 0);
    EXPECT_EQ(flatness(surface, flattener.positions()).flipped, 0);
    EXPECT_TRUE(flattener.report().converged);
  }
}

// Laid flat in concentric rings: each ring on a circle of the next one's size, and deep below what equal
// weights in Tutte's map would leave of it.
TEST(Flatten, TurnsNoTriangleOverInUncutSleeves) {
  for (const auto& [around, rings] : {std::pair(6, 40), std::pair(6, 100), std::pair(24, 40)}) {
    const Surface surface = sleeve(around, rings);
    const Flattener flattener(surface.vertices, surface.triangles);
    EXPECT_TRUE(flattener.report().converged);
    EXPECT_EQ(flatness(surface, flattener.positions()).flipped, 0);
  }
}

TEST(Flatten, DoesNotDependOnUnitOrPlace) {
  const Surface surface = cap(6, 1.2);
  const Points x = flatten(surface.vertices, surface.triangles);
  EXPECT_EQ(x, flatten(surface.vertices, surface.triangles));
  for (const double unit : {std::ldexp(1.0, -400), 32.0, std::ldexp(1.0, 800)}) {
    EXPECT_EQ(flatten(unit * surface.vertices, surface.triangles), unit * x);
  }
  // Which of the edges of a symmetric surface is in the middle rounding decides.
  EXPECT_LT(apart(flatten(1e3 * surface.vertices, surface.triangles) / 1e3, x), 1e-6);
  const SpacePoints far = surface.vertices.rowwise() + Eigen::RowVector3d(1000.0, -500.0, 100.0);
  EXPECT_LT(apart(flatten(far, surface.triangles), x), 1e-6);
}

TEST(Flatten, TakesSoManyStepsAtMost) {
  const Surface surface = cap(9, 2.0);
  FlattenOptions options;
  options.iterations = 1;
  const Flattener flattener(surface.vertices, surface.triangles, options);
  EXPECT_EQ(flattener.report().iterations, 1);
  EXPECT_FALSE(flattener.report().converged);
}

TEST(Flatten, RepeatsTheSecondStep) {
  const Surface surface = cap(9, 1.2);
  FlattenOptions options = two_steps();
  const Flatness once = flatness(surface, flatten(surface.vertices, surface.triangles, options));
  options.iterations = 50;
  const Flattener flattener(surface.vertices, surface.triangles, options);
  const Flatness often = flatness(surface, flattener.positions());
  EXPECT_EQ(flattener.report().iterations, 50);
  EXPECT_LT(often.angle, once.angle);
}

}  // namespace
}  // namespace planar::testing
