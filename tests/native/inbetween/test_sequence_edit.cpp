// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "inbetween/inbetween_support.h"
#include "planar/sequence_edit.h"

namespace planar::testing {
namespace {

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
}

TEST(EditSequence, RefusesWhatItCannotDo) {
  const Shape shape = grid(3);
  const Points& x = shape.vertices;
  Points broken = x;
  broken(4, 1) = std::nan("");
  EXPECT_REFUSAL(edit_sequence({}, {{0, x}}, shape.triangles), "frames is empty");
  EXPECT_REFUSAL(edit_sequence({x}, {{1, x}}, shape.triangles), "edits, row 0: frame 1 is out of range");
  EXPECT_REFUSAL(edit_sequence({x, x}, {{1, x}, {1, x}}, shape.triangles), "frame 1 is edited twice");
  EXPECT_REFUSAL(edit_sequence({x}, {{0, broken}}, shape.triangles), "edits[0].shape, row 4");
  EXPECT_REFUSAL(edit_sequence({x}, {{0, x}}, Triangles()), "triangles is empty");
}

}  // namespace
}  // namespace planar::testing
