// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "flatten/surfaces.h"
#include "planar/flatten.h"
#include "support.h"

namespace planar::testing {
namespace {

Points flat_of(const Surface& surface) { return flatten(surface.vertices, surface.triangles); }

Surface plane(int columns, int rows) {
  return sheet(columns, rows, 1.0, 1.0, [](double u, double v) { return Eigen::RowVector3d(u, v, 0.0); });
}

/// The surface with triangles more.
Surface with(Surface surface, const std::vector<Eigen::RowVector3i>& triangles) {
  const Eigen::Index m = surface.triangles.rows();
  surface.triangles.conservativeResize(m + static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    surface.triangles.row(m + static_cast<Eigen::Index>(i)) = triangles[i];
  }
  return surface;
}

/// A grid whose opposite sides are one: columns×rows cells round a torus.
Surface torus(int columns, int rows) {
  Surface result{SpacePoints(columns * rows, 3), Triangles(2 * columns * rows, 3)};
  int t = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double a = 6.283185307179586 * i / columns, b = 6.283185307179586 * j / rows;
      result.vertices.row(j * columns + i) << (2.0 + std::cos(b)) * std::cos(a),
          (2.0 + std::cos(b)) * std::sin(a), std::sin(b);
      const int p = j * columns + i, q = j * columns + (i + 1) % columns;
      const int r = ((j + 1) % rows) * columns + i, s = ((j + 1) % rows) * columns + (i + 1) % columns;
      result.triangles.row(t++) << p, q, r;
      result.triangles.row(t++) << q, s, r;
    }
  }
  return result;
}

TEST(FlattenHostile, ClosedSurfaces) {
  const Surface open = sleeve(5, 3);
  EXPECT_REFUSAL(flat_of(with(open, {{1, 0, 2}, {2, 0, 3}, {3, 0, 4}})), "cut it open along a seam");
  EXPECT_REFUSAL(flat_of(torus(6, 5)), "cut it open along a seam");
}

TEST(FlattenHostile, SurfacesWithHandles) {
  EXPECT_REFUSAL(flat_of(without(torus(6, 5), [](int t) { return t == 7; })), "1 handle, as that of a cup");
}

TEST(FlattenHostile, SeveralParts) {
  const Surface one = plane(3, 3);
  Surface two = with(one, {});
  two.vertices.conservativeResize(18, 3);
  two.vertices.bottomRows(9) = one.vertices.rowwise() + Eigen::RowVector3d(3.0, 0.0, 0.0);
  two.triangles.conservativeResize(16, 3);
  two.triangles.bottomRows(8) = (one.triangles.array() + 9).matrix();
  EXPECT_REFUSAL(flat_of(two), "2 parts that hang together nowhere: flatten them one by one");
}

TEST(FlattenHostile, EdgesOfThreeTriangles) {
  Surface surface = with(plane(3, 3), {{0, 1, 9}});
  surface.vertices.conservativeResize(10, 3);
  surface.vertices.row(9) << 0.0, 0.0, 1.0;
  EXPECT_NO_THROW(flat_of(surface));  // on the boundary it is a flap
  surface = with(surface, {{1, 4, 9}});
  EXPECT_REFUSAL(flat_of(surface), "the edge of vertices 1 and 4: split the surface there");
}

TEST(FlattenHostile, PiecesThatMeetInAVertex) {
  Surface surface = with(plane(3, 3), {{8, 9, 10}});
  surface.vertices.conservativeResize(11, 3);
  surface.vertices.bottomRows(2) << 2.0, 1.0, 0.0, 1.0, 2.0, 0.0;
  EXPECT_REFUSAL(flat_of(surface), "meet in vertex 8 alone: split the vertex");
}

TEST(FlattenHostile, SurfacesWithOneSide) {
  const int n = 12;
  Surface surface{SpacePoints(2 * n, 3), Triangles(2 * n, 3)};
  for (int i = 0; i < n; ++i) {
    const double a = 6.283185307179586 * i / n;
    for (const int end : {0, 1}) {
      const double r = (end == 0 ? -0.3 : 0.3) * std::cos(a / 2.0),
                   z = (end == 0 ? -0.3 : 0.3) * std::sin(a / 2.0);
      surface.vertices.row(2 * i + end) << (1.0 + r) * std::cos(a), (1.0 + r) * std::sin(a), z;
    }
    const bool last = i + 1 == n;
    const int p = 2 * i, q = 2 * i + 1, r = last ? 1 : 2 * i + 2, s = last ? 0 : 2 * i + 3;
    surface.triangles.row(2 * i) << p, r, q;
    surface.triangles.row(2 * i + 1) << r, s, q;
  }
  EXPECT_REFUSAL(flat_of(surface), "one side only, as a Möbius strip has");
}

TEST(FlattenHostile, NoArea) {
  Surface surface = plane(4, 4);
  surface.vertices.col(1).setZero();
  EXPECT_REFUSAL(flat_of(surface), "has no area: dissolve");
  surface.vertices.setZero();
  EXPECT_REFUSAL(flat_of(surface), "has no area: dissolve");
}

TEST(FlattenHostile, TheSameTriangleTwice) {
  EXPECT_REFUSAL(flat_of(with(Surface{plane(2, 2).vertices, Triangles(0, 3)}, {{0, 1, 2}, {0, 1, 2}})), "");
}

TEST(FlattenHostile, Numbers) {
  Surface surface = plane(3, 3);
  EXPECT_REFUSAL(flatten(SpacePoints(0, 3), surface.triangles), "vertices is empty");
  EXPECT_REFUSAL(flatten(surface.vertices, Triangles(0, 3)), "triangles is empty");
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    SpacePoints vertices = surface.vertices;
    vertices(4, 2) = bad;
    EXPECT_REFUSAL(flatten(vertices, surface.triangles), "vertices, row 4: not a finite number");
  }
  surface.triangles(3, 1) = 9;
  EXPECT_REFUSAL(flat_of(surface), "triangles, row 3: vertex 9 is out of range");
  EXPECT_NO_THROW(flatten(1e308 * plane(3, 3).vertices, plane(3, 3).triangles));
  EXPECT_NO_THROW(flatten(1e-300 * plane(3, 3).vertices, plane(3, 3).triangles));
}

TEST(FlattenHostile, Options) {
  const Surface surface = plane(4, 4);
  const auto with_fixed = [&](std::array<int, 2> fixed) {
    FlattenOptions options;
    options.fixed = fixed;
    return flatten(surface.vertices, surface.triangles, options);
  };
  EXPECT_REFUSAL(with_fixed({0, 16}), "fixed, row 1: vertex 16 is out of range");
  EXPECT_REFUSAL(with_fixed({0, 15}), "fixed: its vertices share no edge");
  EXPECT_REFUSAL(with_fixed({3, 3}), "fixed: its vertices share no edge");
  FlattenOptions options;
  options.iterations = -1;
  EXPECT_REFUSAL(flatten(surface.vertices, surface.triangles, options), "iterations");
  options.iterations = 0;
  options.pin_weight = 0.0;
  EXPECT_REFUSAL(flatten(surface.vertices, surface.triangles, options), "pin_weight");
}

TEST(FlattenHostile, NeedlesAndCoincidentVertices) {
  Surface surface = plane(5, 5);
  surface.vertices.row(6) = surface.vertices.row(7);
  surface.vertices.row(12) = surface.vertices.row(11);
  const Points x = flat_of(surface);
  EXPECT_TRUE(x.allFinite());
  EXPECT_EQ(flatness(surface, x).flipped, 0);
}

TEST(FlattenHostile, ProgressTellsAndStops) {
  const Surface surface = cap(9, 2.4);
  for (const FlattenMethod method : {FlattenMethod::hold, FlattenMethod::two_steps}) {
    FlattenOptions options;
    options.method = method;
    if (method == FlattenMethod::two_steps) options.iterations = 5;
    std::vector<double> shares;
    options.progress = [&shares](double share) {
      shares.push_back(share);
      return true;
    };
    const Points x = flatten(surface.vertices, surface.triangles, options);
    EXPECT_GT(shares.size(), 5);
    EXPECT_EQ(shares.front(), 0.0);
    EXPECT_EQ(shares.back(), 1.0);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    options.progress = {};
    EXPECT_EQ(x, flatten(surface.vertices, surface.triangles, options));
    for (const double stop : {0.0, 0.2, 1.0}) {
      options.progress = [stop](double share) { return share < stop; };
      EXPECT_THROW(flatten(surface.vertices, surface.triangles, options), Cancelled);
    }
  }
}

}  // namespace
}  // namespace planar::testing
