// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/triangle_shape.h"
#include "planar/distortion.h"
#include "planar/poser.h"
#include "support.h"

/// What method hold does with targets and shapes that no animator would ask for on purpose.
namespace planar::testing {
namespace {

class Hostile : public ::testing::TestWithParam<unsigned> {};

/// Triangles that do not lie as at rest when rounded to float32, of those that are not flat there.
int turned_over(const Shape& shape, const Points& x) {
  const auto area = [&](const Points& points, Eigen::Index t) {
    const Eigen::MatrixX2d p = points.cast<float>().cast<double>();
    const Eigen::RowVector2d a = p.row(shape.triangles(t, 1)) - p.row(shape.triangles(t, 0));
    const Eigen::RowVector2d b = p.row(shape.triangles(t, 2)) - p.row(shape.triangles(t, 0));
    return a.x() * b.y() - a.y() * b.x();
  };
  const Flags flat = flat_triangles(shape.vertices, shape.triangles);
  int count = 0;
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    const double rest = area(shape.vertices, t);
    count += !flat[t] && !(area(x, t) * rest > 0.0);
  }
  return count;
}

/// Whether the centre of some triangle lies in another one.
bool lies_over_itself(const Shape& shape, const Points& x) {
  const auto corner = [&](Eigen::Index t, int c) { return x.row(shape.triangles(t, c)); };
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    const Eigen::RowVector2d centre = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0;
    for (Eigen::Index other = 0; other < shape.triangles.rows(); ++other) {
      int left = 0;
      for (int c = 0; c < 3; ++c) {
        const Eigen::RowVector2d side = corner(other, (c + 1) % 3) - corner(other, c);
        const Eigen::RowVector2d to = centre - corner(other, c);
        left += side.x() * to.y() > side.y() * to.x();
      }
      if (other != t && (left == 0 || left == 3)) return true;
    }
  }
  return false;
}

/// Targets near and far, crossing, coinciding, in line.
Points hostile_targets(const Points& rest, const Points& before, std::mt19937& random) {
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  const double reach = std::pow(10.0, 1.75 * value(random) + 0.25);  // 0.03 to 100
  Points targets = before;
  switch (random() % 6) {
    case 0:
      for (Eigen::Index i = 0; i < targets.size(); ++i) targets.data()[i] = reach * value(random);
      break;
    case 1:
      targets.row(static_cast<Eigen::Index>(random() % 4)) +=
          reach * Eigen::RowVector2d(value(random), value(random));
      break;
    case 2:
      targets.row(0).swap(targets.row(static_cast<Eigen::Index>(1 + random() % 3)));
      break;
    case 3:
      targets.rowwise() = Eigen::RowVector2d(reach * value(random), value(random));
      break;
    case 4:
      targets.col(1).setConstant(value(random));
      break;
    default:
      targets = rest;
  }
  return targets;
}

TEST_P(Hostile, TargetsNeverFlipATriangle) {
  // 20 seeds × 500 = 10⁴ targets.
  std::mt19937 random(GetParam());
  Shape shape = grid(5, GetParam() + 1);
  if (GetParam() % 3 == 1) shape.vertices.row(12) = shape.vertices.row(11) + Eigen::RowVector2d(1e-4, 1e-5);
  const auto weight = [&] { return std::pow(10.0, static_cast<double>(random() % 5) - 2.0); };
  Poser poser(shape.vertices, shape.triangles);
  Handles handles = at(shape, {0, 4, 12, 23});
  Points targets = handles.positions(shape.vertices), rest = targets;
  poser.set_handles(handles);
  for (int i = 0; i < 500; ++i) {
    if (random() % 20 == 0) {
      std::vector<int> pinned;
      for (int k = 0; k < 4; ++k) pinned.push_back(static_cast<int>(random() % 25));
      handles = at(shape, pinned);
      rest = targets = handles.positions(shape.vertices);
      poser.set_handles(handles, Eigen::Vector4d(weight(), weight(), weight(), weight()));
    }
    if (random() % 50 == 0) poser.reset();
    targets = hostile_targets(rest, targets, random);
    const Points x = poser.move(targets);
    ASSERT_TRUE(x.allFinite()) << i;
    ASSERT_EQ(turned_over(shape, x), 0) << i;
    ASSERT_EQ(poser.report().flipped, 0);
    ASSERT_NEAR(poser.report().furthest_handle, (handles.positions(x) - targets).rowwise().norm().maxCoeff(),
                1e-9 * (1.0 + targets.norm()));
    if (random() % 10 == 0) {
      ASSERT_EQ(turned_over(shape, poser.refine()), 0) << i;
    }
  }
  // Afterwards the handles at their places bring the rest shape back. Only where it lies over itself, as
  // after one of some 300 such series, no way back may be without a flip: then a reset brings it.
  handles = at(shape, {0, 4, 12, 23});
  poser.set_handles(handles);
  poser.move(handles.positions(shape.vertices));
  for (int i = 0; i < 5 && !poser.report().converged; ++i) poser.settle();
  EXPECT_TRUE(poser.report().converged);
  if (lies_over_itself(shape, poser.positions())) {
    poser.reset();
    poser.move(handles.positions(shape.vertices));
  }
  // A sliver hardly has a shape to come back to; the others do within what settle() leaves.
  EXPECT_LT((poser.settle() - shape.vertices).rowwise().norm().maxCoeff(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Hostile, ::testing::Range(0U, 20U));

TEST(HoldRepair, FlippedTrianglesComeRight) {
  const Shape shape = grid(7);
  const Handles handles = at(shape, {0, 6, 42, 48});
  Poser poser(shape.vertices, shape.triangles);
  poser.set_handles(handles);
  Points folded = shape.vertices;
  folded.row(24) += Eigen::RowVector2d(0.3, 0.05);
  folded.row(16) += Eigen::RowVector2d(0.0, 0.25);
  poser.reset(folded);
  EXPECT_GT(poser.report().flipped, 0);
  int flipped = poser.report().flipped;
  for (int i = 0; i < 5; ++i) {
    poser.move(handles.positions(shape.vertices));
    EXPECT_LE(poser.report().flipped, flipped) << "never made worse";
    flipped = poser.report().flipped;
  }
  EXPECT_LT((poser.settle() - shape.vertices).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_EQ(poser.report().flipped, 0);
}

TEST(HoldRepair, AKnotWithoutInvertedTrianglesBeginsAnew) {
  // A disk of rings about a vertex, and the same going round it twice.
  constexpr int rings = 4, spokes = 12;
  Shape disk{Points::Zero(1 + rings * spokes, 2), Triangles(spokes * (2 * rings - 1), 3)};
  Points knotted = disk.vertices;
  int t = 0;
  for (int ring = 0; ring < rings; ++ring) {
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const int next = (spoke + 1) % spokes, v = 1 + ring * spokes, before = v - spokes;
      const double angle = 2.0 * std::numbers::pi * spoke / spokes;
      disk.vertices.row(v + spoke) << (ring + 1) * std::cos(angle), (ring + 1) * std::sin(angle);
      knotted.row(v + spoke) << (ring + 1) * std::cos(2.0 * angle), (ring + 1) * std::sin(2.0 * angle);
      disk.triangles.row(t++) << (ring == 0 ? 0 : before + spoke), v + spoke, v + next;
      if (ring > 0) disk.triangles.row(t++) << before + spoke, v + next, before + next;
    }
  }
  const int rim = 1 + (rings - 1) * spokes;
  const Handles handles = at(disk, {rim, rim + 3, rim + 6, rim + 9});
  Points targets = handles.positions(disk.vertices);
  targets.row(1) += Eigen::RowVector2d(0.9, 0.4);
  const auto settled = [&](const Points& start) {
    Poser poser(disk.vertices, disk.triangles);
    poser.set_handles(handles);
    poser.reset(start);
    EXPECT_EQ(poser.report().flipped, 0);
    poser.move(targets);
    poser.settle();
    EXPECT_TRUE(poser.report().converged);
    return poser.positions();
  };
  EXPECT_LT((settled(knotted) - settled(disk.vertices)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(HoldRepair, AMirroredStartIsReportedIfItCannotBeRepaired) {
  const Shape shape = grid(5);
  const Handles handles = at(shape, {0, 4, 20});
  Poser poser(shape.vertices, shape.triangles);
  poser.set_handles(handles);
  Points mirrored = shape.vertices;
  mirrored.col(0) *= -1.0;
  poser.reset(mirrored);
  EXPECT_EQ(poser.report().flipped, 32);
  poser.move(handles.positions(shape.vertices));
  poser.settle();
  EXPECT_TRUE(poser.positions().allFinite());
  EXPECT_EQ(poser.report().flipped, distortion(shape.vertices, poser.positions(), shape.triangles).flipped);
}

TEST(HoldRepair, ScaledAndShearedStartsComeBack) {
  const Shape shape = grid(6);
  const Handles handles = at(shape, {0, 5, 33});
  for (const double scale : {0.01, 0.3, 30.0}) {
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(handles);
    Points start = scale * shape.vertices;
    start.col(0) += 2.0 * start.col(1);
    poser.reset(start);
    ASSERT_EQ(poser.report().flipped, 0);
    poser.move(handles.positions(shape.vertices));
    EXPECT_EQ(poser.report().flipped, 0);
    EXPECT_LT((poser.settle() - shape.vertices).cwiseAbs().maxCoeff(), 1e-4) << scale;
    EXPECT_EQ(poser.report().flipped, 0);
  }
}

/// Upright, but so thin that the largest entries of the Hessian drown its smallest eigenvalues.
TEST(HoldRepair, StartsThatAreAlmostALineComeBack) {
  const Shape shape = grid(8);
  for (const auto& [along, across] : {std::pair(1e3, 1e-6), {1e4, 1e-5}, {1e3, 1e-5}, {1e6, 1e-7}}) {
    Points start = shape.vertices;
    start.col(0) *= along;
    start.col(1) *= across;
    Poser poser(shape.vertices, shape.triangles);
    poser.reset(start);
    poser.set_handles(at(shape, {0, 7, 60}));
    for (int i = 0; i < 20 && !poser.report().converged; ++i) {
      if (i == 0) poser.move(start({0, 7, 60}, Eigen::all));
      poser.settle();
    }
    EXPECT_TRUE(poser.positions().allFinite());
    EXPECT_EQ(poser.report().flipped, 0) << along;
  }
}

TEST(HoldRepair, ManyHandlesAndVeryDifferentWeights) {
  const Shape shape = grid(15);
  std::vector<int> vertices;
  for (int i = 0; i < 200; ++i) vertices.push_back(i);
  const Handles handles = at(shape, vertices);
  Poser poser(shape.vertices, shape.triangles);
  Eigen::VectorXd weights(200);
  for (int i = 0; i < 200; ++i) weights[i] = std::pow(10.0, i % 9 - 4);
  poser.set_handles(handles, weights);
  const Points targets = handles.positions(shape.vertices) + 0.3 * random_points(200, 4);
  for (int i = 0; i < 5; ++i) {
    poser.move(targets);
    ASSERT_EQ(poser.report().flipped, 0);
    ASSERT_TRUE(poser.positions().allFinite());
  }
}

}  // namespace
}  // namespace planar::testing
