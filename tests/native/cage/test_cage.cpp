// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <set>

#include "base/index.h"
#include "cage/cage.h"
#include "cage/cage_support.h"
#include "cage/coarsening.h"
#include "cage/refinement.h"
#include "mesh/triangle_shape.h"
#include "slivers.h"

/// What a coarse mesh has of the dense one that it was made from.
namespace planar::testing {
namespace {

struct Topology {
  explicit Topology(const Mesh& mesh) : parts(mesh.n_parts) {
    std::set<int> used(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
    euler = static_cast<int>(used.size()) - static_cast<int>(mesh.edges.size()) +
            static_cast<int>(mesh.triangles.rows());
    pinches = static_cast<int>(mesh.braces.size());
  }
  bool operator==(const Topology&) const = default;

  int parts;
  int euler;  ///< vertices - edges + triangles: parts less holes, for a surface
  int pinches;
};

void expect_like(const Shape& shape, const Coarse& coarse) {
  const Mesh dense(shape.vertices.rows(), shape.triangles), mesh(coarse.points.rows(), coarse.triangles);
  EXPECT_TRUE(Topology(dense) == Topology(mesh))
      << Topology(mesh).parts << " parts, " << Topology(mesh).euler << " for " << Topology(dense).euler;
  // Each dense vertex is in a triangle of its own part, and is where that has it at rest.
  const Cage cage = make_cage(shape.vertices, coarse);
  std::vector<int> part_of(planar::at(dense.n_parts), -1);
  for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
    const Place& place = cage.places[planar::at(v)];
    ASSERT_EQ(place.triangle < 0, dense.part[planar::at(v)] < 0);
    if (place.triangle < 0) continue;
    EXPECT_LT((carried(place, cage.triangles, cage.rest) - shape.vertices.row(v)).norm(), 1e-12);
    const int part = mesh.part[planar::at(cage.triangles(place.triangle, 0))];
    int& known = part_of[planar::at(dense.part[planar::at(v)])];
    if (known < 0) known = part;
    EXPECT_EQ(known, part);
  }
}

double least_angle(const Coarse& coarse) {
  double least = 10.0;
  for (Eigen::Index t = 0; t < coarse.triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::RowVector2d a = coarse.points.row(coarse.triangles(t, c));
      const Eigen::RowVector2d u = coarse.points.row(coarse.triangles(t, (c + 1) % 3)) - a;
      const Eigen::RowVector2d v = coarse.points.row(coarse.triangles(t, (c + 2) % 3)) - a;
      least = std::min(least, std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v)));
    }
  }
  return least * 180.0 / 3.141592653589793;
}

TEST(Coarsening, KeepsPartsHolesSlitsAndWhatOverlaps) {
  const Shape slit = slit_grid(41);
  const Shape overlapping = joined(slit, moved(refined(ring(60), 3), 0.5, 0.5));
  for (const Shape& shape : {grid(50), refined(ring(60), 3), slit, overlapping, overlapping_strip(200, 12)}) {
    const Coarse coarse = coarsened(shape.vertices, shape.triangles, 200);
    EXPECT_LE(coarse.points.rows(), 260);
    EXPECT_GT(least_angle(coarse), 10.0);
    expect_like(shape, coarse);
  }
}

TEST(Coarsening, ComesNearToItsWish) {
  const Shape shape = grid(60);
  for (const int wished : {50, 200, 1000})
    EXPECT_NEAR(static_cast<double>(coarsened(shape.vertices, shape.triangles, wished).points.rows()), wished,
                0.02 * wished);
}

/// Nothing between the legs is seen: no triangle of the cage has vertices on both sides of the slit.
TEST(Coarsening, LegsThatTouchStayApart) {
  const Shape shape = slit_grid(61);
  const Coarse coarse = coarsened(shape.vertices, shape.triangles, 150);
  const std::vector<int> left = leg(shape, true), right = leg(shape, false);
  std::set<int> of_left;
  for (const int v : left) of_left.insert(coarse.triangle_of[planar::at(v)]);
  for (const int v : right) EXPECT_FALSE(of_left.contains(coarse.triangle_of[planar::at(v)])) << v;
}

/// Two rows of triangles are left across what is thin, if there were as many.
TEST(Coarsening, ThinPartsKeepAVertexInside) {
  const Shape shape = overlapping_strip(300, 8);
  const Coarse coarse = coarsened(shape.vertices, shape.triangles, 200);
  const Mesh mesh(coarse.points.rows(), coarse.triangles);
  int across = 0;
  for (const auto& [a, b] : mesh.edges) {
    int sides = 0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
      int ends = 0;
      for (int c = 0; c < 3; ++c) ends += mesh.triangles(t, c) == a || mesh.triangles(t, c) == b;
      sides += ends == 2;
    }
    across += sides == 2 && !mesh.interior[planar::at(a)] && !mesh.interior[planar::at(b)];
  }
  EXPECT_LE(across, 4);  // at the corners of the strip's ends
}

TEST(Coarsening, VerticesOfNoSurfaceStayWithTheirTriangles) {
  // A pinch between two squares, a third triangle on an edge, a triangle twice, one folded back.
  Shape shape = joined(grid(30), moved(grid(30, 3), 1.3, 1.3));
  const auto corner = static_cast<int>(30 * 30 - 1), other = static_cast<int>(30 * 30);
  for (int& v : shape.triangles.reshaped()) v = v == other ? corner : v;
  Triangles more(shape.triangles.rows() + 3, 3);
  more << shape.triangles, 435, 436, 20, shape.triangles.row(700), 610, 611, 609;
  shape.triangles = more;
  const Coarse coarse = coarsened(shape.vertices, shape.triangles, 300);
  std::set<int> sources;
  for (const auto& origin : coarse.origins) sources.insert(origin.source);
  for (const int v : {corner, 435, 436, shape.triangles(700, 0)}) EXPECT_TRUE(sources.contains(v)) << v;
  const Mesh dense(shape.vertices.rows(), shape.triangles), mesh(coarse.points.rows(), coarse.triangles);
  EXPECT_EQ(mesh.n_parts, dense.n_parts);
  EXPECT_LT(coarse.points.rows(), 400);
}

TEST(Coarsening, SliversGo) {
  const Shape shape = with_slivers(grid(50), 3);
  const Coarse coarse = coarsened(shape.vertices, shape.triangles, 200);
  EXPECT_LE(coarse.points.rows(), 260);
  const Flags flat = flat_triangles(coarse.points, coarse.triangles);
  EXPECT_LE(flat.count(), 2);
}

TEST(Coarsening, WhatIsNoSurfaceAtAllIsSolvedAsItIs) {
  Shape soup{random_points(300, 5), Triangles(400, 3)};
  std::mt19937 random(5);
  std::uniform_int_distribution<int> vertex(0, 299);
  for (Eigen::Index t = 0; t < 400; ++t) {
    const int a = vertex(random);
    soup.triangles.row(t) << a, (a + 1 + vertex(random) % 100) % 300, (a + 150 + vertex(random) % 100) % 300;
  }
  EXPECT_FALSE(coarse_for_cage(soup.vertices, soup.triangles, 50));
  EXPECT_FALSE(coarse_for_cage(soup.vertices, soup.triangles, 300));
}

TEST(Refinement, HalvesEdgesNearTheVerticesDownToTheDenseOnes) {
  const Shape shape = slit_grid(61);
  const Coarse coarse = coarsened(shape.vertices, shape.triangles, 200);
  const int inner = 20 * 61 + 15, on_rim = 30;
  const Coarse fine = refined_near(shape.vertices, coarse, {inner, on_rim});
  EXPECT_GT(fine.points.rows(), coarse.points.rows() + 20);
  EXPECT_LE(fine.points.rows(), 2 * coarse.points.rows());
  EXPECT_GT(least_angle(fine), 10.0);
  expect_like(shape, fine);
  for (const int v : {inner, on_rim}) {
    const int* corner = fine.triangles.data() + 3 * fine.triangle_of[planar::at(v)];
    EXPECT_LT((fine.points.row(corner[0]) - fine.points.row(corner[1])).norm(), 2.5 / 60);
  }
}

TEST(CageFit, FindsTheCageOfACarriedShape) {
  const Shape shape = slit_grid(61);
  const Coarse coarse = coarsened(shape.vertices, shape.triangles, 200);
  const Cage cage = make_cage(shape.vertices, refined_near(shape.vertices, coarse, {700, 30}));
  const Mesh mesh(cage.rest.rows(), cage.triangles);
  const Points x = rigid_motion(cage.rest, 1.0, 3.0, -2.0) + 0.02 * random_points(cage.rest.rows(), 4);
  Points dense(shape.vertices.rows(), 2);
  for (Eigen::Index v = 0; v < dense.rows(); ++v)
    dense.row(v) = carried(cage.places[planar::at(v)], cage.triangles, x);
  const Points stored = dense.cast<float>().cast<double>();
  const Points found = CageFit(cage, mesh).fit(stored);
  const Remainder beside(cage, found, stored, 1e-6);
  EXPECT_TRUE(beside.is_empty()) << beside.largest();
}

TEST(CageSample, IsWhereTheMeshIs) {
  const Shape shape = grid(40);
  const Cage cage = make_cage(
      shape.vertices, refined_near(shape.vertices, coarsened(shape.vertices, shape.triangles, 150), {820}));
  const CageSample sample(cage, shape.vertices, shape.triangles);
  Eigen::Matrix2d sheared;
  sheared << 1.3, 0.4, -0.2, 0.7;
  const Points to = (shape.vertices * sheared).rowwise() + Eigen::RowVector2d(3.0, -1.0);
  const Points expected = (cage.rest * sheared).rowwise() + Eigen::RowVector2d(3.0, -1.0);
  EXPECT_LT((sample.at(cage, to) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace planar::testing
