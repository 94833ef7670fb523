// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/diameter.h"
#include "planar/akvf.h"
#include "planar/inbetween.h"
#include "planar/poser.h"
#include "shapes.h"
#include "slivers.h"

/// A drawing turned gives the result turned: no tolerance depends on how its box lies. What is left are
/// rounding errors, which a hundred steps may amplify.
namespace planar::testing {
namespace {

constexpr double same = 1e-6;  // of the size

double apart(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

Shape long_figure() {
  const benchmarks::Shape figure = benchmarks::figure(600);
  Shape shape{figure.vertices / figure.diagonal, figure.triangles};
  shape.vertices.col(0) *= 3.0;
  return shape;
}

class Turned : public ::testing::TestWithParam<PoserMethod> {};

TEST_P(Turned, DrawingsGiveTurnedPoses) {
  const Shape shape = long_figure();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> angle(0.0, 6.283185307179586);
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Drag drag = random_drag(shape, seed, 0.1);
    const auto pose = [&](double turn) {
      const auto turned = [turn](const Points& x) { return rigid_motion(x, turn, 0.0, 0.0); };
      Poser poser(turned(shape.vertices), shape.triangles, {.method = GetParam()});
      poser.set_handles(at(shape, drag.pins));
      for (int i = 1; i <= 5; ++i) poser.move(turned(drag.start + (drag.targets - drag.start) * (i / 5.0)));
      for (int i = 0; i < 3; ++i) poser.refine();
      return rigid_motion(poser.settle(), -turn, 0.0, 0.0);
    };
    EXPECT_LT(apart(pose(angle(random)), pose(0.0)), same) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Turned,
                         ::testing::Values(PoserMethod::hold, PoserMethod::akvf, PoserMethod::arap));

/// Two handles 1.2e-6 of the diameter from their middle, which is as near to 1e-6 of the box's diagonal or
/// nearer, depending on how the drawing is turned.
TEST(TurnedFields, OfHandlesCloseToEachOther) {
  const Shape shape = grid(5);
  const Points& start = shape.vertices;
  const double half = 1.2e-6 * diameter(start) / (start.row(1) - start.row(0)).norm();  // of edge 0-1
  Handles handles;
  handles.vertices.resize(2, 3);
  handles.vertices << 0, 1, 5, 0, 1, 5;
  handles.weights.resize(2, 3);
  handles.weights << 0.5 + half, 0.5 - half, 0.0, 0.5 - half, 0.5 + half, 0.0;
  const auto field = [&](double turn) {
    const Points x = rigid_motion(start, turn, 0.0, 0.0);
    const Points from = handles.positions(x);
    Points velocities(2, 2);
    velocities << from(1, 1) - from(0, 1), from(0, 0) - from(1, 0), 0.0, 0.0;
    return rigid_motion(killing_field(x, shape.triangles, handles, velocities), -turn, 0.0, 0.0);
  };
  EXPECT_LT(apart(field(0.7853981633974483), field(0.0)), 1e-9);
}

TEST(TurnedKeys, GiveTurnedInbetweens) {
  const Shape shape = long_figure();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> angle(0.0, 6.283185307179586);
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Drag drag = random_drag(shape, seed, 0.1);
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(at(shape, drag.pins));
    poser.move(drag.targets);
    const Points posed = poser.settle();
    const auto between = [&](double turn) {
      const auto turned = [turn](const Points& x) { return rigid_motion(x, turn, 0.0, 0.0); };
      const Inbetweens motion({turned(shape.vertices), turned(posed)}, shape.triangles);
      return rigid_motion(motion.at(0.37), -turn, 0.0, 0.0);
    };
    EXPECT_LT(apart(between(angle(random)), between(0.0)), same) << seed;
  }
}

}  // namespace
}  // namespace planar::testing
