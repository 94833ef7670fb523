// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "cutout/cutout_support.h"
#include "mesh/triangle_shape.h"
#include "support.h"

namespace planar::testing {
namespace {

/// Fewer where each takes ten times as long.
#ifdef __SANITIZE_ADDRESS__
constexpr unsigned kMasks = 30;
#else
constexpr unsigned kMasks = 500;
#endif

/// A figure with thin limbs and a hole.
AlphaImage figure(int size) {
  return drawn(size, size, [size](double x, double y) {
    x *= 100.0 / size;
    y *= 100.0 / size;
    const bool trunk = std::hypot((x - 50) / 18, (y - 55) / 28) < 1.0 && std::hypot(x - 50, y - 60) > 6.0;
    const bool arm = std::abs(y - 62 - 0.2 * (x - 50)) < 1.5 && x > 6 && x < 94;
    const bool leg = std::abs(std::abs(x - 50) - 9) < 2.0 && y > 4 && y < 50;
    return trunk || arm || leg;
  });
}

/// Sides of exactly one triangle, each as that triangle goes round it.
std::set<std::pair<int, int>> boundary_of(const Triangles& triangles) {
  std::set<std::pair<int, int>> sides, result;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(sides.emplace(triangles(t, c), triangles(t, (c + 1) % 3)).second);
  }
  for (const auto& [a, b] : sides) {
    if (sides.count({b, a}) == 0) result.emplace(a, b);
  }
  return result;
}

void expect_a_mesh(const Cutout& c) {
  for (Eigen::Index t = 0; t < c.triangles.rows(); ++t)
    ASSERT_GT(doubled_area(c.points, c.triangles.data() + 3 * t), 0.0);
  std::set<std::pair<int, int>> rings;
  for (const Eigen::VectorXi& ring : c.rings) {
    for (Eigen::Index i = 0; i < ring.size(); ++i) rings.emplace(ring[i], ring[(i + 1) % ring.size()]);
  }
  ASSERT_EQ(boundary_of(c.triangles), rings);
  std::vector<char> used(static_cast<std::size_t>(c.points.rows()), 0);
  for (Eigen::Index i = 0; i < c.triangles.size(); ++i)
    used[static_cast<std::size_t>(c.triangles.data()[i])] = 1;
  ASSERT_EQ(std::accumulate(used.begin(), used.end(), 0), c.points.rows());
  ASSERT_NEAR(
      area_of(polygons(c)),
      [&] {
        double doubled = 0.0;
        for (Eigen::Index t = 0; t < c.triangles.rows(); ++t)
          doubled += doubled_area(c.points, c.triangles.data() + 3 * t);
        return 0.5 * doubled;
      }(),
      1e-6 * area_of(polygons(c)));
}

TEST(Cutout, HoldsAllArtOfRandomDrawings) {
  double worst = 180.0;
  for (unsigned seed = 0; seed < kMasks; ++seed) {
    SCOPED_TRACE(seed);
    const AlphaImage alpha = random_art(seed);
    CutoutOptions options;
    options.vertices = seed % 3 == 0 ? 30 : 150;
    options.smallest = 0.0;
    const Cutout found = cutout(alpha, options);
    ASSERT_EQ(lost_pixels(alpha, polygons(found), 0.5), 0);
    ASSERT_EQ(lost_pixels(alpha, found.outline.rings, 0.5), 0);
    expect_a_mesh(found);
    worst = std::min(worst, smallest_angle(found.points, found.triangles));
  }
  EXPECT_GT(worst, 17.0);  // 19 in the release build
}

TEST(Cutout, HasAsManyVerticesAsWished) {
  const AlphaImage alpha = figure(600);
  for (const int wish : {1000, 1500, 4000}) {
    CutoutOptions options;
    options.vertices = wish;
    const Cutout found = cutout(alpha, options);
    EXPECT_NEAR(static_cast<double>(found.points.rows()), wish, 0.2 * wish);
    EXPECT_TRUE(found.reached);
    EXPECT_TRUE(found.said.empty());
    expect_a_mesh(found);
    EXPECT_GT(smallest_angle(found.points, found.triangles), 19.0);
    EXPECT_EQ(found.rings.size(), 3u);  // the arms cross the hole
  }
}

TEST(Cutout, SaysWhenTheWishCannotBe) {
  CutoutOptions options;
  options.vertices = 20;
  const Cutout found = cutout(figure(600), options);
  EXPECT_FALSE(found.reached);
  ASSERT_EQ(found.said.size(), 1u);
  EXPECT_NE(found.said[0].find("needs at least " + std::to_string(found.points.rows()) + " vertices"),
            std::string::npos);
}

TEST(Cutout, HasAsManyVerticesAsWishedWithAnyMargin) {
  for (const double margin : {2.0, 20.0, 50.0, 100.0, 200.0, 1000.0, 16384.0}) {
    SCOPED_TRACE(margin);
    CutoutOptions options;
    options.margin = margin;
    const Cutout found = cutout(figure(72), options);
    EXPECT_NEAR(static_cast<double>(found.points.rows()), 1500.0, 375.0);
    EXPECT_TRUE(found.reached);
    EXPECT_TRUE(found.said.empty());
    EXPECT_EQ(lost_pixels(figure(72), polygons(found), 0.5), 0);
    expect_a_mesh(found);
  }
}

/// A disc with eight legs as thick as a hair.
AlphaImage star(int size) {
  return drawn(size, size, [size](double x, double y) {
    x -= 0.5 * size;
    y -= 0.5 * size;
    if (std::hypot(x, y) < 0.15 * size) return true;
    for (int leg = 0; leg < 8; ++leg) {
      const double angle = 0.2 + leg * 0.785398163, along = x * std::cos(angle) + y * std::sin(angle);
      if (along > 0.0 && along < 0.47 * size && std::abs(y * std::cos(angle) - x * std::sin(angle)) < 0.7)
        return true;
    }
    return false;
  });
}

TEST(Cutout, ThinPartsNeedTheSameForAnyWish) {
  const AlphaImage alpha = star(600);
  for (const double margin : {0.0, 2.0, 5.0}) {
    SCOPED_TRACE(margin);
    CutoutOptions options;
    if (margin > 0.0) options.margin = margin;
    std::set<std::string> said;
    for (const int wish : {3, 10, 50, 100, 160}) {
      options.vertices = wish;
      const Cutout found = cutout(alpha, options);
      ASSERT_EQ(found.said.size(), 1u);
      EXPECT_EQ(found.said[0], "This drawing needs at least " + std::to_string(found.points.rows()) +
                                   (margin > 0.0 ? " vertices; with a larger margin fewer." : " vertices."));
      said.insert(found.said[0]);
      EXPECT_GT(smallest_angle(found.points, found.triangles), 19.0);
      EXPECT_EQ(lost_pixels(alpha, polygons(found), 0.5), 0);
    }
    EXPECT_EQ(said.size(), 1u);
  }
}

TEST(Cutout, VerticesGrowWithTheWish) {
  const AlphaImage alpha = star(600);
  double least = 0.0, before = 0.0;
  for (const int wish : {10, 50, 100, 200, 400, 800, 1200, 1500, 3000}) {
    SCOPED_TRACE(wish);
    CutoutOptions options;
    options.vertices = wish;
    const Cutout found = cutout(alpha, options);
    const auto n = static_cast<double>(found.points.rows());
    if (least == 0.0) least = n;
    EXPECT_LT(least, 250.0);  // two rows along eight legs: 528 with the edge that a wish for 10 comes to
    EXPECT_NEAR(n, std::max<double>(wish, least), 0.25 * std::max<double>(wish, least));
    EXPECT_GT(n, 0.97 * before);
    EXPECT_EQ(found.n_parts, 1);
    expect_a_mesh(found);
    before = n;
  }
}

TEST(Cutout, EdgesAreAsLongAsGiven) {
  CutoutOptions options;
  for (const double edge : {12.0, 30.0}) {
    options.edge = edge;
    const Cutout found = cutout(AlphaImage::Ones(400, 600), options);
    double sum = 0.0;
    for (Eigen::Index t = 0; t < found.triangles.rows(); ++t) {
      for (int c = 0; c < 3; ++c) {
        sum += (found.points.row(found.triangles(t, c)) - found.points.row(found.triangles(t, (c + 1) % 3)))
                   .norm();
      }
    }
    EXPECT_NEAR(sum / static_cast<double>(found.triangles.size()), edge, 0.15 * edge);
    EXPECT_EQ(found.edge, edge);
    EXPECT_TRUE(found.reached);
  }
}

TEST(Cutout, RefusesMeshesThatNobodyCanUse) {
  CutoutOptions options;
  options.edge = 0.01;
  EXPECT_REFUSAL(cutout(AlphaImage::Ones(2000, 2000), options), "vertices, at most 2000000 are made");
}

/// A vertex lies between the two sides of every limb: no triangle has all of its vertices on the boundary and
/// none of its sides.
TEST(Cutout, ThinPartsHaveTwoRowsOfTriangles) {
  const Cutout found = cutout(figure(800));
  Eigen::Index on_boundary = 0;
  for (const Eigen::VectorXi& ring : found.rings) on_boundary += ring.size();
  const auto boundary = boundary_of(found.triangles);
  int across = 0;
  for (Eigen::Index t = 0; t < found.triangles.rows(); ++t) {
    if (found.triangles.row(t).maxCoeff() >= on_boundary) continue;
    int sides = 0;
    for (int c = 0; c < 3; ++c) {
      sides += static_cast<int>(boundary.count({found.triangles(t, c), found.triangles(t, (c + 1) % 3)}));
    }
    across += sides < 2 ? 1 : 0;
  }
  EXPECT_EQ(across, 0);
}

TEST(Cutout, IslandsAreParts) {
  AlphaImage alpha = AlphaImage::Zero(300, 500);
  alpha.block(40, 40, 200, 150).setOnes();
  alpha.block(40, 300, 200, 150).setOnes();
  alpha.block(90, 90, 100, 50).setZero();  // a hole with an island
  alpha.block(130, 105, 20, 20).setOnes();
  CutoutOptions options;
  options.margin = 2.0;
  const Cutout found = cutout(alpha, options);
  EXPECT_EQ(found.n_parts, 3);
  EXPECT_EQ(found.outline.islands, 3);
  EXPECT_EQ(found.rings.size(), 4u);
  for (Eigen::Index t = 0; t < found.triangles.rows(); ++t) {
    for (int c = 1; c < 3; ++c)
      ASSERT_EQ(found.parts[found.triangles(t, c)], found.parts[found.triangles(t, 0)]);
  }
  std::map<int, double> left;
  for (Eigen::Index i = 0; i < found.points.rows(); ++i) {
    const auto [place, fresh] = left.emplace(found.parts[i], found.points(i, 0));
    if (!fresh) place->second = std::min(place->second, found.points(i, 0));
  }
  EXPECT_EQ(left.size(), 3u);
  EXPECT_EQ(found.parts[0], 0);
}

TEST(Cutout, EqualImagesGiveEqualBits) {
  const AlphaImage alpha = figure(300);
  const Cutout a = cutout(alpha), b = cutout(alpha);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Cutout, ManyMoreVerticesThanPixels) {
  CutoutOptions options;
  options.vertices = 8000;
  const Cutout found = cutout(figure(64), options);
  expect_a_mesh(found);
  EXPECT_NEAR(static_cast<double>(found.points.rows()), 8000.0, 2000.0);
}

TEST(Cutout, CanBeCancelledAtAnyTime) {
  CutoutOptions options;
  options.vertices = 200;
  std::vector<double> told;
  options.progress = [&](double share) {
    told.push_back(share);
    return true;
  };
  cutout(figure(100), options);
  EXPECT_EQ(told.front(), 0.0);
  EXPECT_EQ(told.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  for (const double stop : told) {
    options.progress = [stop](double share) { return share < stop; };
    EXPECT_THROW(cutout(figure(100), options), Cancelled);
  }
}

}  // namespace
}  // namespace planar::testing
