// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "inbetween/blended_triangles.h"
#include "inbetween/flip_repair.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"

/// Transitions in which triangles flip, made by blending the keys' positions straight: the worst there is.
namespace planar::testing {
namespace {

struct Blend {
  Blend(Shape shape_, Points to_)
      : shape(std::move(shape_)), to(std::move(to_)), graph(to.rows(), shape.triangles) {}

  Points at(double u) const { return (1.0 - u) * shape.vertices + u * to; }

  FlipRepair repair(
      int threads = 2, const std::function<void(double)>& progress = [](double) {}) {
    ThreadTeam team(threads);
    return {graph,
            shape.vertices,
            to,
            8,
            [this](const Eigen::VectorXd& u) {
              std::vector<Points> frames;
              for (const double share : u) frames.push_back(at(share));
              return frames;
            },
            progress,
            team};
  }

  int flipped(const Points& x) const { return distortion(shape.vertices, x, shape.triangles).flipped; }

  Shape shape;
  Points to;
  EdgeGraph graph;
};

Blend turned_bar() {
  const Shape shape = bar(16, 0.15);
  return {shape, rigid_motion(rolled(shape.vertices, 150.0 * degrees), 140.0 * degrees, 0.2, 0.0)};
}

TEST(FlipRepair, KeepsEveryTriangleUpright) {
  Blend blend = turned_bar();
  ASSERT_GT(blend.flipped(blend.at(0.5)), 0);
  const FlipRepair repair = blend.repair();
  ASSERT_TRUE(repair.needed());
  for (int i = 0; i <= 50; ++i) {
    const double u = i / 50.0;
    EXPECT_EQ(blend.flipped(repair.repaired(blend.at(u), u, 0)), 0) << u;
  }
}

TEST(FlipRepair, LeavesTheKeysAndMovesWithoutJumps) {
  Blend blend = turned_bar();
  ASSERT_GT(blend.flipped(blend.at(0.5)), 0);
  const FlipRepair repair = blend.repair();
  const auto frame = [&](double u) { return repair.repaired(blend.at(u), u, 0); };
  // Frames are solved to 1e-5 of the diagonal, at a linear rate.
  EXPECT_LT(largest_difference(frame(1e-6), blend.shape.vertices), 1e-3);
  EXPECT_LT(largest_difference(frame(1.0 - 1e-6), blend.to), 1e-3);
  std::vector<double> steps;
  Points before = frame(0.0);
  for (int i = 1; i <= 48; ++i) {
    const Points now = frame(i / 48.0);
    steps.push_back(largest_difference(before, now));
    before = now;
  }
  for (std::size_t i = 1; i + 1 < steps.size(); ++i) {
    // The blend itself passes through a bar collapsed to a line, turned inside out; real motions stay
    // below 1.3.
    EXPECT_LT(steps[i], 2.0 * std::max(steps[i - 1], steps[i + 1])) << i;
  }
}

TEST(FlipRepair, IsSymmetricInTimeWhateverTheThreads) {
  Blend forward = turned_bar(), back({forward.to, forward.shape.triangles}, forward.shape.vertices);
  const FlipRepair one = forward.repair(1), other = back.repair(3);
  for (const double u : {0.2, 0.45, 0.7}) {
    EXPECT_LT(
        largest_difference(one.repaired(forward.at(u), u, 0), other.repaired(back.at(1.0 - u), 1.0 - u, 2)),
        1e-4)
        << u;
  }
}

TEST(FlipRepair, TouchesOnlyThePartsThatNeedIt) {
  const Shape one = bar(16, 0.15), two = joined(one, moved(one, 0.0, 2.0));
  Points to = two.vertices;
  to.topRows(51) = turned_bar().to;
  Blend blend(two, to);
  const FlipRepair repair = blend.repair();
  ASSERT_TRUE(repair.needed());
  const Points frame = repair.repaired(blend.at(0.4), 0.4, 1);
  EXPECT_EQ(frame.bottomRows(51), blend.at(0.4).bottomRows(51));
  EXPECT_EQ(blend.flipped(frame), 0);
}

TEST(FlipRepair, LeavesAloneWhatItCannotHelpOrNeedNot) {
  const Shape shape = bar(8);
  EXPECT_FALSE(Blend(shape, rolled(shape.vertices, 0.3)).repair().needed());
  Points mirrored = shape.vertices;
  mirrored.col(1) *= -1.0;
  EXPECT_FALSE(Blend(shape, mirrored).repair().needed());
}

TEST(FlipRepair, CanBeCancelled) {
  Blend blend = turned_bar();
  EXPECT_THROW((void)blend.repair(2,
                                  [](double share) {
                                    if (share > 0.5) throw Cancelled();
                                  }),
               Cancelled);
}

/// The frames of a repair leave and reach the keys with the velocities that they had before it.
TEST(FlipRepair, KeepsTheVelocitiesAtTheKeys) {
  Blend blend = turned_bar();
  const FlipRepair repair = blend.repair();
  // The deviation grows with the square: frames are solved to 1e-5 of the diagonal.
  const double h = 1e-3;
  for (const double u : {h, 1.0 - h}) {
    EXPECT_LT(largest_difference(repair.repaired(blend.at(u), u, 0), blend.at(u)),
              0.1 * h * largest_difference(blend.to, blend.shape.vertices));
  }
}

/// A corner that is pulled through the opposite side, but stops before it: nothing flips, all but.
TEST(FlipRepair, StartsBeforeATriangleFlips) {
  const Shape shape = bar(8, 0.3);
  Blend blend(shape, shape.vertices);
  ThreadTeam team(1);
  const auto repair = [&](double depth) {
    return FlipRepair(
        blend.graph, shape.vertices, shape.vertices, 8,
        [&](const Eigen::VectorXd& shares) {
          std::vector<Points> frames;
          for (const double u : shares) {
            Points x = shape.vertices;
            x(0, 0) += 4.0 * u * (1.0 - u) * depth * 0.125;  // of a cell's length
            frames.push_back(x);
          }
          return frames;
        },
        [](double) {}, team);
  };
  EXPECT_FALSE(repair(0.5).needed());
  const FlipRepair late = repair(0.9);
  ASSERT_TRUE(late.needed());
  Points x = shape.vertices;
  x(0, 0) += 0.9 * 0.125;
  const Points better = late.repaired(x, 0.5, 0);
  EXPECT_GT(0.125 - better(0, 0), 1.5 * (0.125 - x(0, 0)));  // what is left of the cell
}

TEST(BlendedTriangles, AreStretchedEvenlyAndMeasureStrain) {
  const Shape shape = bar(4, 0.5);
  Points to = 1.5 * rigid_motion(shape.vertices, 2.0, 3.0, 1.0);
  const BlendedTriangles blended(shape.vertices, to, shape.triangles);
  for (const double u : {0.0, 0.3, 1.0}) {
    const double scale = 1.0 + 0.5 * u;
    for (int t = 0; t < shape.triangles.rows(); ++t) {
      const int a = shape.triangles(t, 0), b = shape.triangles(t, 1);
      const Eigen::Vector2d side = blended.corner(t, b, u) - blended.corner(t, a, u);
      EXPECT_LT((side.transpose() - scale * (shape.vertices.row(b) - shape.vertices.row(a))).norm(), 1e-12);
      EXPECT_NEAR(blended.strain(t, scale * rigid_motion(shape.vertices, 1.0, 0.0, 0.0), u), 1.0, 1e-9);
      Points wide = scale * shape.vertices;
      wide.col(0) *= 2.5;
      EXPECT_NEAR(blended.strain(t, wide, u), 2.5, 1e-9);
      wide.col(0) *= -1.0;
      EXPECT_EQ(blended.strain(t, wide, u), std::numeric_limits<double>::infinity());
    }
  }
}

/// A disc in the square that turns by two thirds of a turn against its surroundings: no rigid path leads
/// there.
TEST(FlipRepair, InbetweensOfASwirlHaveNoFlippedTriangle) {
  Shape shape = grid(17);
  Points to = shape.vertices;
  for (Eigen::Index i = 0; i < to.rows(); ++i) {
    const Eigen::RowVector2d centre(0.5, 0.5);
    const double r = (shape.vertices.row(i) - centre).norm();
    const double angle = r < 0.5 ? 100.0 * degrees * std::pow(1.0 - 4.0 * r * r, 2) : 0.0;
    to.row(i) = rigid_motion(shape.vertices.row(i) - centre, angle, 0.5, 0.5);
  }
  ASSERT_EQ(distortion(shape.vertices, to, shape.triangles).flipped, 0);
  const Inbetweens motion({shape.vertices, to}, shape.triangles);
  for (int i = 0; i <= 30; ++i) {
    EXPECT_EQ(distortion(shape.vertices, motion.at(i / 30.0), shape.triangles).flipped, 0) << i;
  }
}

}  // namespace
}  // namespace planar::testing
