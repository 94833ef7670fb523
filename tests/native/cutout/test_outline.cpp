// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cutout/contour.h"
#include "cutout/cutout_support.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double kPi = 3.14159265358979;

AlphaImage disc(int size, double radius) {
  return drawn(size, size,
               [=](double x, double y) { return std::hypot(x - 0.5 * size, y - 0.5 * size) <= radius; });
}

CutoutOptions with_margin(double margin) {
  CutoutOptions options;
  options.margin = margin;
  return options;
}

TEST(Outline, OfADiscIsADisc) {
  for (const double margin : {4.0, 9.5, 20.0}) {
    const Outline found = outline(disc(700, 200.0), with_margin(margin));
    ASSERT_EQ(found.rings.size(), 1u);
    const double area = kPi * (200.0 + margin) * (200.0 + margin);
    EXPECT_NEAR(area_of(found.rings), area, 0.005 * area);
    for (Eigen::Index i = 0; i < found.rings[0].rows(); ++i) {
      const double radius = (found.rings[0].row(i) - Eigen::RowVector2d(350.0, 350.0)).norm();
      ASSERT_NEAR(radius, 200.0 + margin, 0.8);  // a sample, as the disc has steps itself
    }
    EXPECT_EQ(found.islands, 1);
    EXPECT_EQ(found.margin, margin);
  }
}

TEST(Outline, KeepsItsPlaceAtAnySizeOfTheImage) {
  for (const int size : {60, 500, 1500, 2600}) {
    const double radius = 0.3 * size, margin = 0.05 * size;
    const Outline found = outline(disc(size, radius), with_margin(margin));
    ASSERT_EQ(found.rings.size(), 1u);
    const Points& ring = found.rings[0];
    EXPECT_NEAR(ring.colwise().mean().norm(), std::hypot(0.5 * size, 0.5 * size), 0.6 * found.sample + 0.02);
    const double area = kPi * (radius + margin) * (radius + margin);
    // Block maxima and pixels larger than samples add up to a half of these.
    EXPECT_NEAR(area_of(found.rings), area,
                2.0 * kPi * (radius + margin) * std::max(0.8, 0.8 * found.sample));
  }
}

TEST(Outline, RoundsCornersAndClosesNotches) {
  // A square with a slit of 10 pixels.
  const AlphaImage alpha = drawn(600, 600, [](double x, double y) {
    const bool square = x > 150 && x < 450 && y > 150 && y < 450;
    return square && !(x > 295 && x < 305 && y > 250);
  });
  CutoutOptions options = with_margin(3.0);
  options.rounding = 1.0;
  const double grown = 306.0 * 306.0 - (4.0 - kPi) * 9.0;
  EXPECT_NEAR(area_of(outline(alpha, options).rings), grown - 4.0 * 200.0, 0.004 * grown);
  options.rounding = 3.0;
  EXPECT_NEAR(area_of(outline(alpha, options).rings), grown, 0.004 * grown);
}

TEST(Outline, HolesAreKeptOrFilled) {
  const AlphaImage ring = drawn(600, 600, [](double x, double y) {
    const double radius = std::hypot(x - 300, y - 300);
    return (radius < 200 && radius > 100) || (std::hypot(x - 300, y - 300) < 20);
  });
  CutoutOptions options = with_margin(4.0);
  const Outline kept = outline(ring, options);
  EXPECT_EQ(kept.islands, 2);
  EXPECT_EQ(kept.holes, 1);
  EXPECT_NEAR(area_of(kept.rings), kPi * (204.0 * 204.0 - 96.0 * 96.0 + 24.0 * 24.0), 1200.0);
  for (const Points& r : kept.rings)
    EXPECT_EQ(signed_area(r) > 0.0, std::abs((r.row(0).array() - 300.0).matrix().norm() - 96.0) > 3.0);
  options.holes = Holes::fill;
  const Outline filled = outline(ring, options);
  EXPECT_EQ(filled.rings.size(), 1u);
  EXPECT_EQ(filled.filled_holes, 1);
  EXPECT_NEAR(area_of(filled.rings), kPi * 204.0 * 204.0, 800.0);
}

TEST(Outline, HolesTooSmallForATriangleAreFilled) {
  const AlphaImage alpha =
      drawn(600, 600, [](double x, double y) { return std::hypot(x - 300, y - 300) > 14.0; });
  CutoutOptions options = with_margin(4.0);
  options.edge = 40.0;
  EXPECT_EQ(outline(alpha, options).filled_holes, 1);
  options.edge = 8.0;
  EXPECT_EQ(outline(alpha, options).holes, 1);
}

TEST(Outline, SpecksAreDropped) {
  AlphaImage alpha = disc(700, 200.0);
  alpha.block(20, 30, 3, 3).setOnes();
  alpha.block(600, 600, 40, 40).setOnes();
  const Outline found = outline(alpha);
  EXPECT_EQ(found.islands, 2);
  EXPECT_EQ(found.dropped_islands, 1);
  EXPECT_EQ(found.dropped_pixels, 9);
  CutoutOptions options;
  options.smallest = 0.0;
  EXPECT_EQ(outline(alpha, options).islands, 3);
  options.smallest = 0.02;
  EXPECT_EQ(outline(alpha, options).islands, 1);
  options.smallest = 0.999;  // what is left has something
  EXPECT_EQ(outline(alpha, options).islands, 1);
}

TEST(Outline, TouchingCornersMakeOneIsland) {
  AlphaImage alpha = AlphaImage::Zero(600, 600);
  alpha.block(100, 100, 200, 200).setOnes();
  alpha.block(300, 300, 200, 200).setOnes();
  const Outline found = outline(alpha);
  EXPECT_EQ(found.islands, 1);
  EXPECT_EQ(lost_pixels(alpha, found.rings, 0.5), 0);
}

TEST(Outline, OfOnePixelAndOfAllOfTheImage) {
  const Outline one = outline(AlphaImage::Ones(1, 1));
  ASSERT_EQ(one.rings.size(), 1u);
  EXPECT_EQ(lost_pixels(AlphaImage::Ones(1, 1), one.rings, 0.5), 0);
  AlphaImage alpha = AlphaImage::Zero(300, 200);
  alpha(299, 0) = 1.0f;
  const Outline corner = outline(alpha);
  EXPECT_LT((corner.rings[0].colwise().mean() - Eigen::RowVector2d(0.5, 299.5)).norm(), 0.2);
  const Outline all = outline(AlphaImage::Ones(90, 1400), with_margin(6.0));
  ASSERT_EQ(all.rings.size(), 1u);
  EXPECT_NEAR(area_of(all.rings), 1412.0 * 102.0, 0.02 * 1412.0 * 102.0);
  EXPECT_NEAR(all.rings[0].col(0).minCoeff(), -6.0, 1.5 * all.sample);
}

TEST(Outline, FaintPixelsAreArtAboveTheThreshold) {
  AlphaImage alpha = 0.1f * disc(600, 150.0);
  alpha.block(280, 280, 40, 40).setOnes();
  EXPECT_GT(area_of(outline(alpha).rings), 60000.0);
  CutoutOptions options;
  options.threshold = 0.2;
  EXPECT_LT(area_of(outline(alpha, options).rings), 4000.0);
}

TEST(Outline, RefusesWhatIsNoImage) {
  EXPECT_REFUSAL(outline(AlphaImage(0, 5)), "alpha: an image of 5 x 0 pixels");
  EXPECT_REFUSAL(outline(AlphaImage::Zero(3, 16385)), "make it smaller");
  EXPECT_REFUSAL(outline(AlphaImage::Zero(40, 50)), "all of the image is transparent");
  AlphaImage alpha = AlphaImage::Ones(4, 4);
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), -0.01f, 1.01f}) {
    alpha(2, 1) = wrong;
    EXPECT_REFUSAL(outline(alpha), "alpha, row 2: not a number from 0 to 1");
  }
}

TEST(Outline, RefusesOptionsOutOfRange) {
  const AlphaImage alpha = AlphaImage::Ones(4, 4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [&alpha](const std::function<void(CutoutOptions&)>& change) {
    CutoutOptions options;
    change(options);
    return outline(alpha, options);
  };
  EXPECT_REFUSAL(with([](auto& o) { o.vertices = 2; }), "vertices: 2, expected 3 to 2000000");
  for (const double wrong : {0.0, -1.0, nan}) EXPECT_REFUSAL(with([&](auto& o) { o.edge = wrong; }), "edge");
  for (const double wrong : {-1.0, nan, 1e9}) {
    EXPECT_REFUSAL(with([&](auto& o) { o.margin = wrong; }), "margin");
    EXPECT_REFUSAL(with([&](auto& o) { o.rounding = wrong; }), "rounding");
  }
  for (const double wrong : {-0.1, 1.0, nan}) {
    EXPECT_REFUSAL(with([&](auto& o) { o.threshold = wrong; }), "threshold");
    EXPECT_REFUSAL(with([&](auto& o) { o.smallest = wrong; }), "smallest");
  }
  for (const double wrong : {0.5, 101.0, nan})
    EXPECT_REFUSAL(with([&](auto& o) { o.finest = wrong; }), "finest");
}

TEST(Outline, CanBeCancelled) {
  CutoutOptions options;
  std::vector<double> told;
  options.progress = [&](double share) {
    told.push_back(share);
    return true;
  };
  outline(AlphaImage::Ones(4, 4), options);
  EXPECT_EQ(told.front(), 0.0);
  EXPECT_EQ(told.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  options.progress = [](double share) { return share < 0.1; };
  EXPECT_THROW(outline(AlphaImage::Ones(4, 4), options), Cancelled);
}

}  // namespace
}  // namespace planar::testing
