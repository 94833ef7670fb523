// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "inbetween/inbetween_support.h"

namespace planar::testing {
namespace {

TEST(InbetweenReport, SaysThatAllIsWell) {
  const Shape shape = bar(16, 0.15);
  const Points bent = rolled(shape.vertices, 80.0 * degrees), more = rolled(shape.vertices, 120.0 * degrees);
  const Inbetweens motion({shape.vertices, bent, more}, shape.triangles);
  ASSERT_EQ(motion.report().size(), 2U);
  for (const TransitionReport& report : motion.report()) {
    EXPECT_TRUE(report.converged);
    EXPECT_GE(report.iterations, 1);
    EXPECT_LT(report.iterations, 20);
    EXPECT_TRUE(report.unrepaired.empty());
  }
}

TEST(InbetweenReport, SaysWhatDidNotConverge) {
  const Shape shape = bar(16, 0.15);
  InbetweenOptions options;
  options.max_iterations = 1;
  options.tolerance = 1e-9;
  const Inbetweens motion({shape.vertices, rolled(shape.vertices, 150.0 * degrees)}, shape.triangles,
                          options);
  EXPECT_FALSE(motion.report()[0].converged);
  EXPECT_EQ(motion.report()[0].iterations, 1);
}

TEST(InbetweenReport, SaysWhichPartsFlip) {
  const Shape one = bar(8, 0.3), two = joined(one, moved(one, 0.0, 2.0));
  Points to = two.vertices;
  const Eigen::Index half = one.vertices.rows();
  to.bottomRows(half).col(1) = 4.0 - to.bottomRows(half).col(1).array();
  const Inbetweens motion({two.vertices, to, two.vertices}, two.triangles);
  EXPECT_EQ(motion.report()[0].unrepaired, std::vector<int>{1});
  EXPECT_EQ(motion.report()[1].unrepaired, std::vector<int>{1});
  // Edges have no sides to lie on.
  Edges edges(1, 2);
  edges << 0, 1;
  EXPECT_TRUE(Inbetweens({two.vertices, to}, edges).report()[0].unrepaired.empty());
}

}  // namespace
}  // namespace planar::testing
