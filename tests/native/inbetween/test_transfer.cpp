// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/transfer.h"

namespace planar::testing {
namespace {

TEST(TransferMotion, OntoItsOwnShapeComesBack) {
  const Bending motion;
  const auto frames = transfer_motion(motion.frames, motion.frames[0], motion.shape.triangles);
  EXPECT_LT(largest_difference(frames, motion.frames), 1e-9);
}

/// A shape that is the source turned, scaled and moved makes the motion turned, scaled and moved.
TEST(TransferMotion, FollowsSimilarities) {
  const Bending motion;
  const auto similar = [](const Points& x) { return Points(2.5 * rigid_motion(x, 0.7, 3.0, -4.0)); };
  const auto frames = transfer_motion(motion.frames, similar(motion.frames[0]), motion.shape.triangles);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_LT(largest_difference(frames[k], similar(motion.frames[k])), 1e-9);
  }
}

/// Parts and isolated vertices move as the source's, whatever their shape.
TEST(TransferMotion, MovesPartsLikeTheSources) {
  Shape shape = joined(grid(4), moved(grid(3, 2), 5.0, 0.0));
  shape.vertices.conservativeResize(26, 2);
  shape.vertices.row(25) << 9.0, 9.0;
  Points to = shape.vertices;
  to.topRows(16).col(0).array() += 2.0;
  to.bottomRows(1).col(1).array() -= 3.0;
  Points other = shape.vertices;
  other.topRows(16) = grid(4, 7).vertices;
  const auto frames = transfer_motion({shape.vertices, to}, other, shape.triangles);
  EXPECT_LT(largest_difference(frames[0], other), 1e-12);
  // The shapes are alike but for a few percent of turn and scale, which the ways are turned and scaled by.
  EXPECT_LT(((frames[1] - other) - (to - shape.vertices)).rowwise().norm().maxCoeff(), 0.1);
  const Points way = frames[1] - frames[0];
  EXPECT_LT((way.topRows(16).rowwise() - way.row(0)).cwiseAbs().maxCoeff(), 1e-12);
}

/// A thicker bar takes over the bending without being distorted where the source is not.
TEST(TransferMotion, BendsAThickerBar) {
  const Bending motion;
  const Points thick = bar(30, 0.16).vertices;
  const auto frames = transfer_motion(motion.frames, thick, motion.shape.triangles);
  EXPECT_LT(largest_difference(frames[0], thick), 1e-12);
  const Points& last = frames.back();
  // As far round as the source: the angle between the two ends.
  const auto direction = [](const Points& x, int i) {
    return std::atan2(x(i + 3, 1) - x(i, 1), x(i + 3, 0) - x(i, 0));
  };
  const double turned = direction(last, 88 - 1) - direction(last, 1);
  const double source = direction(motion.frames.back(), 88 - 1) - direction(motion.frames.back(), 1);
  EXPECT_NEAR(wrapped_angle(turned - source), 0.0, 0.05);
  for (const Points& frame : frames) EXPECT_EQ(distortion(thick, frame, motion.shape.triangles).flipped, 0);
}

TEST(TransferMotion, WorksOnContours) {
  const int n = 30;
  Points line(n, 2);
  for (int i = 0; i < n; ++i) line.row(i) << static_cast<double>(i) / n, 0.0;
  const Edges sides = contour(n, true);
  const auto frames = inbetween({line, rolled(line, 3.0)}, uniform(7), sides);
  EXPECT_LT(largest_difference(transfer_motion(frames, line, sides), frames), 1e-9);
}

TEST(TransferMotion, RefusesWhatItCannotDo) {
  const Shape shape = grid(3);
  const Points& x = shape.vertices;
  Points broken = x;
  broken(4, 1) = std::nan("");
  EXPECT_REFUSAL(transfer_motion({}, x, shape.triangles), "frames is empty");
  EXPECT_REFUSAL(transfer_motion({x, x.topRows(5)}, x, shape.triangles), "frames[1] has 5 rows");
  EXPECT_REFUSAL(transfer_motion({x}, broken, shape.triangles), "shape, row 4");
}

}  // namespace
}  // namespace planar::testing
