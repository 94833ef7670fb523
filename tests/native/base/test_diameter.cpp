// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/diameter.h"
#include "support.h"

namespace planar::testing {
namespace {

double brute(const Points& x) {
  double longest = 0.0;
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    longest = std::max(longest, (x.rowwise() - x.row(i)).rowwise().norm().maxCoeff());
  }
  return longest;
}

TEST(Diameter, IsTheLargestDistance) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Points x = random_points(1 + static_cast<Eigen::Index>(seed % 40), seed);
    EXPECT_NEAR(diameter(x), brute(x), 1e-15) << seed;
    const Points turned = rigid_motion(x, 0.1 * seed, 0.0, 0.0);
    EXPECT_NEAR(diameter(turned), brute(x), 1e-14) << seed;
  }
  EXPECT_NEAR(diameter(ring(31).vertices), brute(ring(31).vertices), 1e-15);
}

TEST(Diameter, OfPointsInLineAndFew) {
  EXPECT_EQ(diameter(Points(0, 2)), 0.0);
  EXPECT_EQ(diameter(Points::Ones(5, 2)), 0.0);
  EXPECT_EQ(diameter((Points(4, 2) << 0, 0, 3, 4, 1.5, 2, 0, 0).finished()), 5.0);
  EXPECT_EQ(diameter((Points(4, 2) << 0, 0, 1, 0, 0, 1, 1, 1).finished()), std::sqrt(2.0)) << "as its box's";
}

}  // namespace
}  // namespace planar::testing
