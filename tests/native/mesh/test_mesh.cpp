// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "mesh/mesh.h"
#include "support.h"

namespace planar::testing {
namespace {

Triangles triangles(std::initializer_list<std::array<int, 3>> rows) {
  Triangles result(static_cast<Eigen::Index>(rows.size()), 3);
  Eigen::Index row = 0;
  for (const auto& corner : rows) result.row(row++) << corner[0], corner[1], corner[2];
  return result;
}

TEST(Mesh, FindsEdgesOnceWhateverTheOrientation) {
  const Mesh mesh(4, triangles({{0, 1, 2}, {1, 2, 3}}));
  const std::vector<std::array<int, 2>> expected{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}};
  EXPECT_EQ(mesh.edges, expected);
  EXPECT_EQ(mesh.find_edge(3, 1), 3);
  EXPECT_EQ(mesh.find_edge(0, 3), -1);
}

TEST(Mesh, KnowsInteriorVertices) {
  const Shape shape = grid(4);
  const Mesh mesh(16, shape.triangles);
  for (int i = 0; i < 16; ++i) {
    const bool inside = i % 4 > 0 && i % 4 < 3 && i / 4 > 0 && i / 4 < 3;
    EXPECT_EQ(mesh.interior[static_cast<std::size_t>(i)] != 0, inside) << i;
  }
}

TEST(Mesh, CountsTheRimsOfHolesAsBoundary) {
  const Shape shape = ring(12);
  const Mesh mesh(24, shape.triangles);
  EXPECT_EQ(mesh.interior, std::vector<char>(24, 0));
}

TEST(Mesh, ClosedPartsHaveNoInterior) {
  const Mesh tetrahedron(4, triangles({{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}}));
  EXPECT_EQ(tetrahedron.interior, std::vector<char>(4, 0));
}

TEST(Mesh, NumbersPartsAndSetsIsolatedVerticesApart) {
  const Mesh mesh(8, triangles({{1, 2, 3}, {5, 7, 6}}));
  EXPECT_EQ(mesh.part, (std::vector<int>{-1, 0, 0, 0, -1, 1, 1, 1}));
  EXPECT_EQ(mesh.n_parts, 2);
}

TEST(Mesh, BracesPiecesThatMeetInOneVertex) {
  const Mesh hinge(5, triangles({{0, 1, 2}, {2, 3, 4}}));
  EXPECT_EQ(hinge.n_parts, 1);
  const std::vector<std::array<int, 3>> expected{{2, 0, 3}};
  EXPECT_EQ(hinge.braces, expected);
  EXPECT_TRUE(Mesh(16, grid(4).triangles).braces.empty());
}

TEST(Mesh, AllowsEdgesWithThreeTriangles) {
  const Mesh fin(5, triangles({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}));
  EXPECT_EQ(fin.edges.size(), 7U);
  EXPECT_TRUE(fin.braces.empty());
}

TEST(Mesh, RefusalsNameTheRow) {
  EXPECT_REFUSAL(Mesh(3, triangles({{0, 1, 2}, {0, 1, 3}})), "triangles, row 1: vertex 3 is out of range");
  EXPECT_REFUSAL(Mesh(3, triangles({{0, -1, 2}})), "triangles, row 0: vertex -1");
  EXPECT_REFUSAL(Mesh(3, triangles({{0, 1, 2}, {0, 1, 2}, {2, 1, 2}})), "row 2: names a vertex twice");
}

}  // namespace
}  // namespace planar::testing
