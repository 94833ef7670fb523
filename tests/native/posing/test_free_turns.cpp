// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planar/poser.h"
#include "support.h"

/// Handles at one point do not say how a part is turned: then it keeps its turn, whatever rounding makes of
/// the fit.
namespace planar::testing {
namespace {

constexpr double still = 1e-9;  // some thousand moves' rounding, relative to coordinates of up to ten

class FreeTurn : public ::testing::TestWithParam<PoserMethod> {};

/// A bar of columns×rows vertices, 2 long and 0.4 wide, about the origin.
Shape bar(int columns, int rows) {
  Shape shape{Points(columns * rows, 2), Triangles(2 * (columns - 1) * (rows - 1), 3)};
  for (int i = 0; i < columns * rows; ++i) {
    shape.vertices.row(i) << 2.0 * (i % columns) / (columns - 1) - 1.0,
        0.4 * (i / columns) / (rows - 1) - 0.2;
  }
  int row = 0;
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i;
      shape.triangles.row(row++) << a, a + 1, a + columns;
      shape.triangles.row(row++) << a + 1, a + columns + 1, a + columns;
    }
  }
  return shape;
}

/// The largest |q_a - q_b - (p_a - p_b)|: 0 for a translation.
double turned(const Points& p, const Points& q) {
  const Points way = q - p;
  return (way.colwise().maxCoeff() - way.colwise().minCoeff()).norm();
}

TEST_P(FreeTurn, APartWithOnePinTranslates) {
  for (unsigned seed = 0; seed < 5000; ++seed) {
    std::mt19937 random(seed);
    const Shape shape = bar(5, 2);
    const Handles handles = seed % 2 == 0 ? at(shape, {static_cast<int>(random() % 10)})
                                          : inside(shape, {static_cast<int>(random() % 8)});
    Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
    poser.set_handles(handles, Eigen::VectorXd::Constant(1, std::pow(10.0, -static_cast<int>(seed % 4))));
    for (unsigned i = 0; i < 8; ++i) {
      const Points target = (i % 3 == 0 ? 10.0 : 0.1) * random_points(1, 10 * seed + i);
      poser.move(target);
      ASSERT_LT(turned(shape.vertices, poser.positions()), still) << seed << ", move " << i;
      ASSERT_LT(poser.report().furthest_handle, still);
    }
  }
}

TEST_P(FreeTurn, LongDragsOfOnePinAddNothingUp) {
  const Shape shape = bar(21, 5);
  for (const double weight : {1.0, 0.1, 0.003}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
      const Handles handles = at(shape, {static_cast<int>(5 * seed)});
      poser.set_handles(handles, Eigen::VectorXd::Constant(1, weight));
      Points target = handles.positions(shape.vertices);
      for (unsigned i = 0; i < 100; ++i) {
        target += 0.05 * random_points(1, 100 * seed + i);
        poser.move(target);
        ASSERT_LT(turned(shape.vertices, poser.positions()), still) << weight << ", " << seed << ", " << i;
      }
    }
  }
}

TEST_P(FreeTurn, APartWithPinsAtOnePointTranslates) {
  // The middle of the edge that the triangles 2 and 3 share, once from each of them, and the pin of both.
  const Shape shape = bar(5, 2);
  const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights{
      {1e-17, 0.3, 0.7}, {0.3, 0.0, 0.7}, {0.0, 0.3, 0.7}};
  const Handles handles = Handles::in_triangles(Eigen::Vector3i(2, 3, 2), weights, shape.triangles, 10);
  ASSERT_LT((handles.positions(shape.vertices).rowwise() - handles.positions(shape.vertices).row(0)).norm(),
            1e-15);
  for (unsigned seed = 0; seed < 2500; ++seed) {
    Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
    poser.set_handles(handles, Eigen::Vector3d(1.0, 1.0, 0.5));
    for (unsigned i = 0; i < 8; ++i) {
      // Together, or each to a target of its own.
      Points targets = random_points(3, 10 * seed + i);
      if (i % 2 == 0) targets.rowwise() = targets.row(0).eval();
      poser.move(targets);
      ASSERT_LT(turned(shape.vertices, poser.positions()), still) << seed << ", move " << i;
    }
  }
}

TEST_P(FreeTurn, PinsOnALineTurnWithTheirTargets) {
  // Three pins on a line, near to each other or apart: turned input gives turned output. Moderate drags,
  // which have one minimum each; settle() ends within 1e-5 of the diagonal of it.
  const Shape shape = bar(5, 2);
  for (unsigned seed = 0; seed < 1250; ++seed) {
    const Handles handles = seed % 2 == 0 ? at(shape, {0, 2, 4}) : inside(shape, {0, 2, 6}, 0.5, 0.0);
    const double angle = 0.005 * seed;
    const Points rest = handles.positions(shape.vertices);
    Points targets = rest + 0.2 * random_points(3, seed);
    Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
    Poser other(rigid_motion(shape.vertices, angle, 0.3, 0.2), shape.triangles, {.method = GetParam()});
    poser.set_handles(handles);
    other.set_handles(handles);
    for (int i = 0; i < 2; ++i) {
      poser.move(targets);
      other.move(rigid_motion(targets, angle, 0.3, 0.2));
      const Points expected = rigid_motion(poser.settle(), angle, 0.3, 0.2);
      ASSERT_LT((other.settle() - expected).cwiseAbs().maxCoeff(), 1e-3) << seed;
      targets = rest;
    }
  }
}

TEST_P(FreeTurn, TwoPinsThatAreHardlyApartTurn) {
  // By a millionth of the diagonal; akvf takes pins within that of their middle for one.
  const Shape shape = bar(5, 2);
  const double share = GetParam() == PoserMethod::hold ? 4e-6 : 4e-5;
  for (const double angle : {0.3, 2.0, -3.0}) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights{{1.0, 0.0, 0.0},
                                                                            {1.0 - share, share, 0.0}};
    const Handles handles = Handles::in_triangles(Eigen::Vector2i(3, 3), weights, shape.triangles, 10);
    Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
    poser.set_handles(handles);
    poser.move(rigid_motion(handles.positions(shape.vertices), angle, 0.2, 0.1));
    EXPECT_LT((poser.settle() - rigid_motion(shape.vertices, angle, 0.2, 0.1)).cwiseAbs().maxCoeff(), 1e-5)
        << angle;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, FreeTurn,
                         ::testing::Values(PoserMethod::hold, PoserMethod::akvf, PoserMethod::arap));

}  // namespace
}  // namespace planar::testing
