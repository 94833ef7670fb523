// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "inbetween/inbetween_support.h"
#include "inbetween/paper_inbetween.h"
#include "planar/distortion.h"
#include "planar/sequence_edit.h"
#include "planar/transfer.h"

/// In-betweens of shapes and numbers that are unusual, but not refused.
namespace planar::testing {
namespace {

double length(const Points& x, const Edges& edges, Eigen::Index i) {
  return (x.row(edges(i, 1)) - x.row(edges(i, 0))).norm();
}

/// A soup of two parts: a figure of lines with a ring for a head, and a lone stick; limbs turn by far more
/// than their neighbours, and no edge changes its length.
struct Figure {
  Points from{Points::Zero(14, 2)}, to;
  Edges edges{14, 2};

  Figure() {
    from << 0, 0, 0, 1, 0, 2, -0.5, 2.5, 0, 3, 0.5, 2.5,  // trunk and head
        -1, 1.5, -2, 1.5, 1, 1.5, 2, 1.5, -1, -1, 1, -1,  // arms and legs
        5, 0, 6, 0;                                       // stick
    edges << 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 2, 1, 6, 6, 7, 1, 8, 8, 9, 0, 10, 0, 11, 3, 5, 12, 13;
    to = from;
    turn({6, 7}, 1, 150.0);
    turn({7}, 6, 150.0);
    turn({8, 9}, 1, -100.0);
    turn({2, 3, 4, 5}, 1, 40.0);
    turn({10}, 0, -60.0);
    to = rigid_motion(to, 20.0 * degrees, 1.0, 0.5);
    to.bottomRows(2).rowwise() += Eigen::RowVector2d(3.0, 0.0);
  }

  void turn(const std::vector<int>& vertices, int about, double angle) {
    const Eigen::RowVector2d centre = to.row(about);
    for (const int v : vertices) {
      to.row(v) = rigid_motion(to.row(v) - centre, angle * degrees, 0.0, 0.0) + centre;
    }
  }
};

TEST(InbetweenOfSoups, BranchesAndRingsKeepTheirLengths) {
  const Figure figure;
  for (const int frames : {4, 24}) {
    for (const Points& frame : inbetween({figure.from, figure.to}, uniform(frames), figure.edges)) {
      for (Eigen::Index i = 0; i < figure.edges.rows(); ++i) {
        EXPECT_NEAR(length(frame, figure.edges, i), length(figure.from, figure.edges, i), 1e-3) << i;
      }
    }
  }
  // The near arm, which turns by 150° and a further 150°, does so one way round and evenly.
  const Points half = inbetween({figure.from, figure.to}, Eigen::VectorXd::Constant(1, 0.5), figure.edges)[0];
  const auto bend = [](const Points& x) {
    const Complex upper(x(6, 0) - x(1, 0), x(6, 1) - x(1, 1)), lower(x(7, 0) - x(6, 0), x(7, 1) - x(6, 1));
    return std::arg(lower / upper);
  };
  EXPECT_NEAR(wrapped_angle(bend(half) - bend(figure.from)), 75.0 * degrees, 1.0 * degrees);
}

TEST(InbetweenOfSoups, TakeTurnsAndGoBackTheWayTheyCame) {
  const Figure figure;
  InbetweenOptions options;
  options.turns = (Eigen::MatrixXi(1, 2) << 0, 1).finished();
  auto forward = inbetween({figure.from, figure.to}, uniform(9), figure.edges, options);
  // The stick has turned by a quarter of the 380° half way through the first half.
  const auto direction = [](const Points& x) { return std::atan2(x(13, 1) - x(12, 1), x(13, 0) - x(12, 0)); };
  EXPECT_NEAR(wrapped_angle(direction(forward[2]) - direction(figure.from)), 95.0 * degrees, 1e-9);
  options.turns = -options.turns;
  const auto back = inbetween({figure.to, figure.from}, uniform(9), figure.edges, options);
  std::reverse(forward.begin(), forward.end());
  EXPECT_LT(largest_difference(forward, back), 1e-9);
}

/// (12)'s angles, breadth first: along a rolled bar they grow with x, up to whole turns of all of them.
TEST(BreadthFirstTurns, FollowARolledBar) {
  const Shape shape = bar(80);
  const EdgeGraph graph(shape.vertices.rows(), shape.triangles);
  const double angle = 500.0 * degrees;
  const Eigen::VectorXd turns = breadth_first_turns(graph, shape.vertices, rolled(shape.vertices, angle));
  const auto middle = [&](Eigen::Index i) {
    const auto [a, b] = graph.edges[static_cast<std::size_t>(i)];
    return (shape.vertices(a, 0) + shape.vertices(b, 0)) / 2.0;
  };
  const double lift = std::round((turns[0] - angle * middle(0)) / (2.0 * std::numbers::pi));
  for (Eigen::Index i = 0; i < turns.size(); ++i) {
    EXPECT_NEAR(turns[i], angle * middle(i) + 2.0 * std::numbers::pi * lift, angle / 40.0) << i;
  }
}

/// Each part has its own rotation and way: all are exact whatever the others do.
TEST(InbetweenOfManyParts, EveryPartMovesRigidly) {
  Shape shape = grid(3);
  Points to = shape.vertices, expected = to;
  const auto moved_part = [&](int part, double share) {
    const Points x = moved(grid(3, static_cast<unsigned>(part)), 2.0 * part, 0.0).vertices;
    const Eigen::RowVector2d centre = x.colwise().mean(), way(0.3 * part, 1.0 - 0.01 * part);
    const double angle = share * (part % 7 - 3) * 55.0 * degrees;
    Points result = rigid_motion(x.rowwise() - centre, angle, 0.0, 0.0);
    result.rowwise() += centre + share * way;
    return result;
  };
  const int parts = 200;
  Points half(9 * parts, 2);
  for (int part = 0; part < parts; ++part) {
    const Shape next{moved_part(part, 0.0), grid(3).triangles};
    shape = part == 0 ? next : joined(shape, next);
    half.middleRows(9 * part, 9) = moved_part(part, 0.5);
  }
  to.resize(9 * parts, 2);
  for (int part = 0; part < parts; ++part) to.middleRows(9 * part, 9) = moved_part(part, 1.0);
  const Points frame = inbetween({shape.vertices, to}, Eigen::VectorXd::Constant(1, 0.5), shape.triangles)[0];
  EXPECT_LT(largest_difference(frame, half), 1e-9);
}

TEST(InbetweenOfUnusualShapes, NothingDependsOnVerySmallAndLargeUnits) {
  const Shape shape = bar(30);
  const Points end = rolled(shape.vertices, 200.0 * degrees);
  const auto frames = inbetween({shape.vertices, end}, uniform(5), shape.triangles);
  for (const double unit : {1e-6, 1e6}) {
    const auto scaled = inbetween({unit * shape.vertices, unit * end}, uniform(5), shape.triangles);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_LT(largest_difference(frames[i], scaled[i] / unit), 1e-12) << unit;
    }
  }
  // A million of its lengths away from the origin its coordinates have ten digits left.
  const Eigen::RowVector2d far(1e6, -1e6);
  const auto moved_far =
      inbetween({shape.vertices.rowwise() + far, end.rowwise() + far}, uniform(5), shape.triangles);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_LT(largest_difference(frames[i], moved_far[i].rowwise() - far), 1e-7);
  }
}

void expect_no_worse_between(const Shape& shape, const Points& end) {
  const Distortion last = distortion(shape.vertices, end, shape.triangles);
  ASSERT_EQ(last.flipped, 0);
  for (const Points& frame : inbetween({shape.vertices, end}, uniform(12), shape.triangles)) {
    const Distortion d = distortion(shape.vertices, frame, shape.triangles);
    EXPECT_EQ(d.flipped, 0);
    EXPECT_LE(d.area, 1.001 * last.area);
    EXPECT_LE(d.angle, 1.001 * last.angle);
  }
}

TEST(InbetweenOfUnusualShapes, SingleTrianglesThinStripsAndRingsKeepTheirShape) {
  Shape triangle{Points(3, 2), Triangles(1, 3)};
  triangle.vertices << 0.0, 0.0, 1.0, 0.0, 0.0, 1.0;
  triangle.triangles << 0, 1, 2;
  Points thinner(3, 2);
  thinner << 0.0, 0.0, -1.0, 0.2, 0.1, -2.0;
  expect_no_worse_between(triangle, thinner);
  const Shape strip = bar(100, 1e-4);
  expect_no_worse_between(strip, rolled(strip.vertices, 700.0 * degrees));
  const Shape hole = ring(40);
  Points twisted = hole.vertices;  // its inner side turned against the outer one
  twisted.bottomRows(40) = rigid_motion(hole.vertices.bottomRows(40), 15.0 * degrees, 0.0, 0.0);
  expect_no_worse_between(hole, rigid_motion(twisted, 170.0 * degrees, 1.0, 0.0));
}

/// A key with some triangles turned over, or all of them.
TEST(InbetweenOfUnusualShapes, FlippedKeysGoBackTheWayTheyCame) {
  const Shape shape = grid(8);
  Points folded = rigid_motion(shape.vertices, 2.0, 1.0, 0.0), mirrored = folded;
  folded.row(27) += 0.8 * (folded.row(30) - folded.row(27));
  mirrored.col(0) *= -1.0;
  for (const Points& end : {folded, mirrored}) {
    auto forward = inbetween({shape.vertices, end}, uniform(9), shape.triangles);
    std::reverse(forward.begin(), forward.end());
    EXPECT_LT(largest_difference(forward, inbetween({end, shape.vertices}, uniform(9), shape.triangles)),
              1e-6);
  }
}

/// Numbers whose squares are no numbers any more: an error, or frames, but no frames that are not finite.
TEST(InbetweenOfUnusualShapes, HugeAndTinyNumbersGiveFramesOrAnError) {
  const Shape shape = grid(4);
  const Points end = rigid_motion(grid(4, 2).vertices, 2.0, 1.0, 0.0);
  for (const double unit : {1e-320, 1e-200, 1e120, 1e160, 1e300}) {
    for (const auto method : {InbetweenMethod::midpoint, InbetweenMethod::paper, InbetweenMethod::global}) {
      InbetweenOptions options;
      options.method = method;
      try {
        for (const Points& frame :
             inbetween({unit * shape.vertices, unit * end}, uniform(4), shape.triangles, options)) {
          EXPECT_TRUE(frame.allFinite()) << unit << ' ' << static_cast<int>(method);
        }
      } catch (const SolveError&) {
      }
    }
  }
}

TEST(MotionOfUnusualShapes, OverflowIsAnErrorAndEdgesWithoutLengthFollowTheOthers) {
  const Shape shape = grid(4);
  const auto frames = inbetween({shape.vertices, rigid_motion(grid(4, 2).vertices, 2.0, 1.0, 0.0)},
                                uniform(5), shape.triangles);
  std::vector<Points> huge = frames;
  for (Points& frame : huge) frame *= 1e200;
  EXPECT_THROW((void)transfer_motion(huge, huge[0], shape.triangles), SolveError);
  // An edge that is rounding error at first and has a length later on.
  for (const double apart : {0.0, 1e-12, 1e-9}) {
    std::vector<Points> source = frames;
    source[0].row(5) = source[0].row(6) + Eigen::RowVector2d(apart, 0.0);
    for (const Points& frame : transfer_motion(source, shape.vertices, shape.triangles)) {
      EXPECT_LT(frame.cwiseAbs().maxCoeff(), 10.0) << apart;
    }
    for (const Points& frame : edit_sequence(source, {{0, shape.vertices}}, shape.triangles)) {
      EXPECT_LT(frame.cwiseAbs().maxCoeff(), 10.0) << apart;
    }
  }
}

}  // namespace
}  // namespace planar::testing
