// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "cutout/distance_transform.h"
#include "cutout/regions.h"

namespace planar::testing {
namespace {

Mask random_mask(int width, int height, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution set(share);
  Mask mask(width, height, 0);
  for (std::uint8_t& value : mask.values()) value = set(random) ? 1 : 0;
  return mask;
}

double brute_force(const Mask& sites, int x, int y) {
  double nearest = 1e9;
  for (int j = 0; j < sites.height(); ++j) {
    for (int i = 0; i < sites.width(); ++i) {
      if (sites(i, j) != 0) nearest = std::min(nearest, std::hypot(i - x, j - y));
    }
  }
  return nearest;
}

void expect_exact(const Mask& sites, double reach) {
  const NearestSites found = nearest_sites(sites, reach);
  for (int y = 0; y < sites.height(); ++y) {
    for (int x = 0; x < sites.width(); ++x) {
      const double expected = brute_force(sites, x, y);
      ASSERT_NEAR(static_cast<double>(found.distance(x, y)), std::min(expected, reach), 1e-5)
          << x << " " << y;
      const std::int32_t site = found.site(x, y);
      ASSERT_EQ(site >= 0, expected < reach);
      if (site < 0) continue;
      ASSERT_NE(sites.values()[at(site)], 0);
      ASSERT_NEAR(std::hypot(site % sites.width() - x, site / sites.width() - y), expected, 1e-9);
    }
  }
  EXPECT_EQ(distance_to(sites, reach).values(), found.distance.values());
}

TEST(DistanceTransform, AsByBruteForce) {
  unsigned seed = 0;
  for (const double share : {0.002, 0.03, 0.3, 0.9}) {
    for (const double reach : {1000.0, 7.3, 1.0}) expect_exact(random_mask(41, 29, share, ++seed), reach);
  }
  expect_exact(random_mask(1, 37, 0.1, 1), 1000.0);
  expect_exact(random_mask(37, 1, 0.1, 2), 1000.0);
  expect_exact(Mask(5, 4, 1), 10.0);
  expect_exact(Mask(5, 4, 0), 10.0);
}

TEST(Regions, HangTogetherBySides) {
  Mask mask(6, 4, 0);
  for (const auto& [x, y] : {std::pair{0, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}, {3, 2}, {5, 3}}) mask(x, y) = 1;
  const Regions regions = regions_of(mask);
  EXPECT_EQ(regions.count, 3);
  EXPECT_EQ(regions.region(0, 0), 0);
  EXPECT_EQ(regions.region(2, 0), 0);  // joined in the next row
  EXPECT_EQ(regions.region(3, 2), 1);  // touches by a corner only
  EXPECT_EQ(regions.region(5, 3), 2);
  EXPECT_EQ(regions.region(1, 0), -1);
}

}  // namespace
}  // namespace planar::testing
