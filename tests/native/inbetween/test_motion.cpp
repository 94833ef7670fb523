// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/motion.h"

/// Transfer of a motion and editing of a sequence.
namespace planar::testing {
namespace {

struct Bending {
  Shape shape = bar(30);
  std::vector<Points> frames =
      inbetween({shape.vertices, rigid_motion(rolled(shape.vertices, 200.0 * degrees), 0.4, 2.0, 1.0)},
                uniform(9), shape.triangles);
};

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
  Points target = shape.vertices;
  target.topRows(16) = grid(4, 7).vertices;
  const auto frames = transfer_motion({shape.vertices, to}, target, shape.triangles);
  EXPECT_LT(largest_difference(frames[0], target), 1e-12);
  // The shapes are alike but for a few percent of turn and scale, which the ways are turned and scaled by.
  EXPECT_LT(((frames[1] - target) - (to - shape.vertices)).rowwise().norm().maxCoeff(), 0.1);
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

TEST(EditSequence, WithoutAChangeComesBack) {
  const Bending motion;
  EXPECT_EQ(edit_sequence(motion.frames, {}, motion.shape.triangles), motion.frames);
  const auto frames =
      edit_sequence(motion.frames, {{3, motion.frames[3]}, {0, motion.frames[0]}}, motion.shape.triangles);
  EXPECT_LT(largest_difference(frames, motion.frames), 1e-9);
}

TEST(EditSequence, OneEditIsTheTransferFromItsFrame) {
  const Bending motion;
  const Points edited = rigid_motion(1.2 * motion.frames[4], 0.3, 0.0, 0.5);
  const auto frames = edit_sequence(motion.frames, {{4, edited}}, motion.shape.triangles);
  EXPECT_EQ(frames[4], edited);
  const Complex s = std::polar(1.2, 0.3);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto edge = [&](const Points& x) { return Complex(x(60, 0) - x(4, 0), x(60, 1) - x(4, 1)); };
    EXPECT_LT(std::abs(edge(frames[k]) - s * edge(motion.frames[k])), 1e-9);
    const Eigen::RowVector2d shift = edited.colwise().mean() - motion.frames[4].colwise().mean();
    EXPECT_LT((frames[k].colwise().mean() - motion.frames[k].colwise().mean() - shift).norm(), 1e-9);
  }
}

/// A change that is kept from the first and the last frame fades towards both.
TEST(EditSequence, FadesBetweenEdits) {
  const Bending motion;
  const Points& middle = motion.frames[4];
  Points edited = middle;
  edited.topRows(45) = rigid_motion(middle.topRows(45), 0.5, 0.0, 0.0);  // half of it turned
  const auto frames = edit_sequence(
      motion.frames, {{8, motion.frames[8]}, {4, edited}, {0, motion.frames[0]}}, motion.shape.triangles);
  EXPECT_EQ(frames[4], edited);
  EXPECT_EQ(frames[0], motion.frames[0]);
  double before = 0.0;
  for (std::size_t k = 0; k <= 4; ++k) {
    const auto angle = [&](const Points& x) { return std::atan2(x(6, 1) - x(0, 1), x(6, 0) - x(0, 0)); };
    const double change = wrapped_angle(angle(frames[k]) - angle(motion.frames[k]));
    EXPECT_NEAR(change, 0.125 * static_cast<double>(k), 0.03);
    EXPECT_GE(change, before - 1e-9);
    before = change;
  }
}

TEST(EditSequence, WorksOnContours) {
  const int n = 30;
  Points line(n, 2);
  for (int i = 0; i < n; ++i) line.row(i) << static_cast<double>(i) / n, 0.0;
  const Edges sides = contour(n, true);
  const auto frames = inbetween({line, rolled(line, 3.0)}, uniform(7), sides);
  EXPECT_LT(largest_difference(edit_sequence(frames, {{2, frames[2]}}, sides), frames), 1e-9);
  EXPECT_LT(largest_difference(transfer_motion(frames, line, sides), frames), 1e-9);
}

TEST(Motion, RefusesWhatItCannotDo) {
  const Shape shape = grid(3);
  const Points& x = shape.vertices;
  Points broken = x;
  broken(4, 1) = std::nan("");
  EXPECT_REFUSAL(transfer_motion({}, x, shape.triangles), "frames is empty");
  EXPECT_REFUSAL(transfer_motion({x, x.topRows(5)}, x, shape.triangles), "frames[1] has 5 rows");
  EXPECT_REFUSAL(transfer_motion({x}, broken, shape.triangles), "target, row 4");
  EXPECT_REFUSAL(edit_sequence({x}, {{1, x}}, shape.triangles), "edits, row 0: frame 1 is out of range");
  EXPECT_REFUSAL(edit_sequence({x, x}, {{1, x}, {1, x}}, shape.triangles), "frame 1 is edited twice");
  EXPECT_REFUSAL(edit_sequence({x}, {{0, broken}}, shape.triangles), "edits[0].shape, row 4");
  EXPECT_REFUSAL(edit_sequence({x}, {{0, x}}, Triangles()), "triangles is empty");
}

}  // namespace
}  // namespace planar::testing
