// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "flatten/surfaces.h"
#include "planar/flatten.h"
#include "support.h"

namespace planar::testing {
namespace {

Eigen::VectorXi indices(const std::vector<int>& v) {
  return Eigen::Map<const Eigen::VectorXi>(v.data(), static_cast<Eigen::Index>(v.size()));
}

Surface saddle() {
  return sheet(12, 10, 2.0, 1.5,
               [](double u, double v) { return Eigen::RowVector3d(u, v, 0.6 * (u - 1.0) * (v - 0.7)); });
}

struct Pinned {
  Pinned() : surface(saddle()), flattener(surface.vertices, surface.triangles) {}

  Handles at(const std::vector<int>& vertices) const {
    return Handles::at_vertices(indices(vertices), surface.vertices.rows());
  }

  Surface surface;
  Flattener flattener;
};

TEST(FlattenPins, GoWhereTheyShould) {
  Pinned it;
  const Points free = it.flattener.positions();
  it.flattener.set_pins(it.at({0, 11, 115}));
  EXPECT_EQ(it.flattener.positions(), free);
  Points targets(3, 2);
  targets << free.row(0), free.row(11), free.row(115) + Eigen::RowVector2d(0.3, 0.4);
  for (int i = 0; i < 5; ++i) it.flattener.move(targets);
  const Points x = it.flattener.settle();
  EXPECT_TRUE(it.flattener.report().converged);
  EXPECT_LT(it.flattener.report().furthest_handle, 0.01);
  EXPECT_LT((x.row(115) - targets.row(2)).norm(), 0.01);
  EXPECT_EQ(flatness(it.surface, x).flipped, 0);
}

TEST(FlattenPins, DependOnThePlacesAndNotOnTheWay) {
  Pinned it;
  const Points free = it.flattener.positions();
  it.flattener.set_pins(it.at({0, 119}));
  Points targets(2, 2);
  targets << free.row(0), free.row(119) + Eigen::RowVector2d(-0.8, 0.5);
  it.flattener.move(targets);
  it.flattener.settle();
  targets.row(1) = free.row(119);
  it.flattener.move(targets);
  EXPECT_LT((it.flattener.settle() - free).cwiseAbs().maxCoeff(), 1e-3);
  it.flattener.reset();
  EXPECT_EQ(it.flattener.positions(), free);
}

TEST(FlattenPins, SettleWithoutThemGoesBackToLeastDistortion) {
  Pinned it;
  const Points free = it.flattener.positions();
  it.flattener.set_pins(it.at({0, 119}));
  Points targets(2, 2);
  targets << free.row(0), 1.5 * free.row(119);
  it.flattener.move(targets);
  it.flattener.settle();
  EXPECT_GT(apart(free, it.flattener.positions()), 0.1);
  it.flattener.set_pins(it.at({}));
  EXPECT_LT(apart(free, it.flattener.settle()), 1e-3);
}

TEST(FlattenPins, LinesHoldTheirVertices) {
  Pinned it;
  HeldLine line{indices({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}), {0.0, -1.0}, {3.0, 0.3}};
  it.flattener.set_pins(it.at({}), {line});
  const Points x = it.flattener.settle();
  EXPECT_TRUE(it.flattener.report().converged);
  const Eigen::RowVector2d normal = Eigen::RowVector2d(-0.3, 3.0).normalized();
  for (int v = 0; v < 12; ++v) {
    EXPECT_NEAR(normal.dot(x.row(v) - line.point), 0.0, 1e-3);
  }
  EXPECT_LT(it.flattener.report().furthest_handle, 1e-3);
  // Along the line they may go as they like.
  EXPECT_GT((x.row(11) - x.row(0)).norm(), 1.9);
  EXPECT_EQ(flatness(it.surface, x).flipped, 0);
}

TEST(FlattenPins, AnEdgeIsKeptStraightWhileAPinIsDragged) {
  Pinned it;
  const Points free = it.flattener.positions();
  const std::vector<int> edge{0, 12, 24, 36, 48, 60, 72, 84, 96, 108};
  const auto bow = [&edge](const Points& x) {
    double worst = 0.0;
    const Eigen::RowVector2d along = (x.row(edge.back()) - x.row(edge.front())).normalized();
    for (const int v : edge) {
      const Eigen::RowVector2d way = x.row(v) - x.row(edge.front());
      worst = std::max(worst, std::abs(along.x() * way.y() - along.y() * way.x()));
    }
    return worst;
  };
  EXPECT_GT(bow(free), 0.005);
  it.flattener.set_pins(it.at({65}), {it.flattener.fitted_line(indices(edge))},
                        Eigen::VectorXd::Constant(1, 2.0));
  for (int i = 1; i <= 4; ++i) {
    it.flattener.move(free.row(65) + 0.1 * i * Eigen::RowVector2d(1.0, 0.5));
    EXPECT_EQ(it.flattener.report().flipped, 0);
  }
  const Points x = it.flattener.settle();
  EXPECT_LT(bow(x), 1e-3);
}

TEST(FlattenPins, PinsInsideTrianglesAndRefine) {
  Pinned it;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights(1, 3);
  weights << 0.2, 0.3, 0.5;
  const Handles inside =
      Handles::in_triangles(indices({40}), weights, it.surface.triangles, it.surface.vertices.rows());
  it.flattener.set_pins(inside);
  const Points start = inside.positions(it.flattener.positions());
  it.flattener.move(start + Points::Constant(1, 2, 0.25));
  int frames = 0;
  while (!it.flattener.report().converged && frames < 50) {
    it.flattener.refine();
    ++frames;
  }
  EXPECT_LT(frames, 50);
  EXPECT_LT((inside.positions(it.flattener.positions()) - start).norm() - 0.25 * std::sqrt(2.0), 1e-6);
}

TEST(FlattenPins, RefuseWhatTheyCannotBe) {
  Pinned it;
  const HeldLine good{indices({0, 1}), {0.0, 0.0}, {1.0, 0.0}};
  const auto set = [&](HeldLine line) { it.flattener.set_pins(it.at({3}), {good, line}); };
  EXPECT_REFUSAL(set({indices({}), {0.0, 0.0}, {1.0, 0.0}}), "lines, row 1: no vertices");
  EXPECT_REFUSAL(set({indices({0}), {0.0, 0.0}, {0.0, 0.0}}), "lines, row 1: no direction");
  EXPECT_REFUSAL(set({indices({0}), {0.0, std::nan("")}, {1.0, 0.0}}), "lines, row 1: not a finite number");
  EXPECT_REFUSAL(set({indices({120}), {0.0, 0.0}, {1.0, 0.0}}), "vertex 120 is out of range");
  EXPECT_REFUSAL(it.flattener.set_pins(it.at({0}), {}, Eigen::VectorXd::Zero(1)), "weights, row 0");
  EXPECT_REFUSAL(it.flattener.fitted_line(indices({4, 4})), "vertices: they do not tell a line");
  EXPECT_REFUSAL(it.flattener.fitted_line(indices({4, 120})), "vertex 120 is out of range");
  it.flattener.set_pins(it.at({0, 5}));
  const Points x = it.flattener.positions();
  EXPECT_REFUSAL(it.flattener.move(Points::Zero(1, 2)), "targets has 1 rows, expected 2");
  EXPECT_REFUSAL(it.flattener.move(Points::Constant(2, 2, std::nan(""))), "targets, row 0");
  EXPECT_EQ(it.flattener.positions(), x);
  EXPECT_THROW(it.flattener.move(Points::Constant(2, 2, 1e300)), SolveError);
  EXPECT_EQ(it.flattener.positions(), x);
}

}  // namespace
}  // namespace planar::testing
