// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "characters.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/poser.h"

/// Parts that hang together by joints.
namespace planar::testing {
namespace {

/// Pairs of vertices of several parts.
struct Joints {
  std::vector<int> first, second;
};

double widest_gap(const Points& x, const Joints& joints) {
  return largest_difference(x(joints.first, Eigen::all), x(joints.second, Eigen::all));
}

/// Bars of length 1, each one's end on the next one's beginning, hinged there; turned up and down by `bend`.
struct Chain {
  Shape shape = bar(10);
  int n = static_cast<int>(shape.vertices.rows());
  Joints joints;

  explicit Chain(int count, double bend = 0.0) {
    const Shape link = shape;
    shape.vertices = rigid_motion(link.vertices, bend, 0.0, 0.0);
    for (int i = 1; i < count; ++i) {
      joints.first.push_back(i * n - 2);  // the middle of an end
      joints.second.push_back(i * n + 1);
      const Eigen::RowVector2d end = shape.vertices.row(i * n - 2);
      shape = joined(
          shape, {rigid_motion(link.vertices, i % 2 == 0 ? bend : -bend, end.x(), end.y()), link.triangles});
    }
  }

  Poser poser(const std::vector<int>& pins) const {
    Poser result(shape.vertices, shape.triangles);
    result.set_joints(at(shape, joints.first), at(shape, joints.second));
    result.set_handles(at(shape, pins));
    return result;
  }
};

Points rows_of(const Points& x, const std::vector<int>& vertices) { return x(vertices, Eigen::all); }

TEST(PoserJoints, TheFreeOneOfTwoBarsFollowsRigidly) {
  const Chain chain(2);
  const std::vector<int> pins{1, chain.n - 5};
  Poser poser = chain.poser(pins);
  for (int i = 1; i <= 20; ++i) {
    const Points all = rigid_motion(chain.shape.vertices, 0.1 * i, 0.05 * i, -0.02 * i);
    poser.move(rows_of(all, pins));
    EXPECT_LT(largest_difference(poser.positions(), all), 1e-9) << i;
  }
  EXPECT_LT(largest_difference(poser.settle(), rigid_motion(chain.shape.vertices, 2.0, 1.0, -0.4)), 1e-9);
}

TEST(PoserJoints, ABarOnAHingeTurnsAboutIt) {
  const Chain chain(2);
  const std::vector<int> pins{1, 16, chain.n - 2, 2 * chain.n - 2};
  Poser poser = chain.poser(pins);
  Points targets = rows_of(chain.shape.vertices, pins);
  for (const double angle : {0.2, 0.5, 1.5, -2.0}) {
    targets.row(3) << 1.0 + std::cos(angle), std::sin(angle);
    poser.move(targets);
    poser.settle();
    Points wanted = chain.shape.vertices;
    wanted.bottomRows(chain.n) =
        rigid_motion(wanted.bottomRows(chain.n).rowwise() - Eigen::RowVector2d(1.0, 0.0), angle, 1.0, 0.0);
    EXPECT_TRUE(poser.report().converged);
    EXPECT_LT(largest_difference(poser.positions(), wanted), 1e-4) << angle;
  }
}

TEST(PoserJoints, AChainOfTenSwungByOneEndStaysJoined) {
  const Chain chain(10);
  const std::vector<int> pins{1, 10 * chain.n - 2};
  Poser poser = chain.poser(pins);
  Points targets = rows_of(chain.shape.vertices, pins);
  int settled = 0;
  for (int i = 1; i <= 100; ++i) {
    targets.row(1) << 10.0 * std::cos(0.06 * i) * (1.0 - 0.005 * i), 6.0 * std::sin(0.06 * i);
    poser.move(targets);
    EXPECT_EQ(poser.report().flipped, 0);
    EXPECT_LT(widest_gap(poser.positions(), chain.joints), 0.02);
    if (i % 25 != 0) continue;
    poser.settle();
    settled += poser.report().converged;
    EXPECT_LT(widest_gap(poser.positions(), chain.joints), 1e-3 * 10.0);
  }
  EXPECT_EQ(settled, 4);
}

/// A free bar between two pins, pulled about: back in the same place after thousands of moves.
TEST(PoserJoints, NothingDrifts) {
  const Chain chain(3);
  const std::vector<int> pins{1, 16, 2 * chain.n - 5};
  Poser poser = chain.poser(pins);
  const Points start = rows_of(chain.shape.vertices, pins);
  const auto go = [&](int i) {
    Points targets = start;
    targets.row(2) += Eigen::RowVector2d(-0.2 - 0.2 * std::cos(0.1 * i), 0.3 * std::sin(0.1 * i));
    poser.move(targets);
  };
  for (int i = 0; i < 63; ++i) go(i);
  go(0);
  const Points first = poser.settle();
  for (int i = 0; i < 5000; ++i) go(i);
  go(0);
  EXPECT_LT(largest_difference(poser.settle(), first), 1e-4);
  for (int i = 0; i < 100; ++i) go(0);
  const Points still = poser.positions();
  for (int i = 0; i < 5000; ++i) go(0);
  EXPECT_LT(largest_difference(poser.positions(), still), 1e-9);
}

/// Three pairs hold two bars together as one is: near to what a single mesh does.
TEST(PoserJoints, APatchOfThemIsRigid) {
  Chain chain(2);
  for (const int side : {-1, 1}) {
    chain.joints.first.push_back(chain.n - 2 + side);
    chain.joints.second.push_back(chain.n + 1 + side);
  }
  const Shape whole = bar(20);
  Shape one = whole;
  one.vertices.col(0) *= 2.0;
  const std::vector<int> pins{1, 16, 2 * chain.n - 2}, pins_of_one{1, 16, 61};
  Poser poser = chain.poser(pins), single(one.vertices, one.triangles);
  single.set_handles(at(one, pins_of_one));
  Points targets = rows_of(chain.shape.vertices, pins);
  targets.row(2) << 1.6, 0.8;
  poser.move(targets);
  single.move(targets);
  EXPECT_NEAR((poser.settle().row(2 * chain.n - 2) - single.settle().row(61)).norm(), 0.0, 1e-3);
  for (int i = 0; i <= 10; ++i) {
    EXPECT_LT((poser.positions().row(3 * i + 1) - single.positions().row(3 * i + 1)).norm(), 2e-3) << i;
    EXPECT_LT((poser.positions().row(chain.n + 3 * i + 1) - single.positions().row(30 + 3 * i + 1)).norm(),
              2e-3);
  }
  EXPECT_LT(widest_gap(poser.positions(), chain.joints), 1e-3 * 2.0);
}

TEST(PoserJoints, FollowTheDrawingHoweverItLies) {
  const Chain chain(4, 0.3);
  const std::vector<int> pins{1, 4 * chain.n - 2};
  Points targets = rows_of(chain.shape.vertices, pins);
  const auto placed = [](const Points& x) { return Points(250.0 * rigid_motion(x, 1.3, 20.0, -30.0)); };
  Poser here = chain.poser(pins);
  Chain turned = chain;
  turned.shape.vertices = placed(chain.shape.vertices);
  Poser there = turned.poser(pins);
  for (int i = 1; i <= 10; ++i) {
    targets.row(1) += Eigen::RowVector2d(-0.15, 0.1);
    here.move(targets);
    there.move(placed(targets));
  }
  EXPECT_LT(largest_difference(there.settle(), placed(here.settle())), 250.0 * 4e-4);
}

TEST(PoserJoints, RefineByShortWays) {
  Chain chain(5, 0.2);
  for (const int side : {-1, 1}) {  // all but a hinge are stiff, so that the bars bend
    for (const int i : {1, 2, 3}) {
      chain.joints.first.push_back(i * chain.n - 2 + side);
      chain.joints.second.push_back(i * chain.n + 1 + side);
    }
  }
  const std::vector<int> pins{1, 16, 5 * chain.n - 2};
  Poser poser = chain.poser(pins);
  Points targets = rows_of(chain.shape.vertices, pins);
  targets.row(2) << 2.0, 2.5;
  poser.move(targets);
  for (int i = 0; i < 300 && !poser.report().converged; ++i) {
    const Points before = poser.positions();
    poser.refine();
    EXPECT_LT(largest_difference(poser.positions(), before), 0.02 * 5.0) << i;  // the diameter is less than 5
  }
  EXPECT_TRUE(poser.report().converged);
  EXPECT_LT(widest_gap(poser.positions(), chain.joints), 1e-3 * 5.0);
}

TEST(PoserJoints, WhatHangsOnNothingThatIsPinnedStays) {
  const Chain chain(3);
  Poser poser(chain.shape.vertices, chain.shape.triangles);
  poser.set_handles(at(chain.shape, {1, 31}));
  poser.set_joints(at(chain.shape, {chain.n + 31}), at(chain.shape, {2 * chain.n + 1}));  // of the other two
  const Points targets = (Points(2, 2) << 0.0, 0.5, 0.3, 1.2).finished();
  poser.move(targets);
  const Points posed = poser.settle();
  EXPECT_EQ(posed.bottomRows(2 * chain.n), chain.shape.vertices.bottomRows(2 * chain.n));
  // Without joints the first bar is as in a mesh of its own, to the bit.
  Poser alone(chain.shape.vertices, chain.shape.triangles);
  alone.set_handles(at(chain.shape, {1, 31}));
  alone.move(targets);
  EXPECT_LT(largest_difference(alone.settle(), posed), 1e-9);
}

TEST(PoserJoints, BearWildMovesWithoutFlips) {
  Chain chain(5);
  for (const int side : {-1, 1}) {  // the third holds on to the second as a whole
    chain.joints.first.push_back(2 * chain.n - 2 + side);
    chain.joints.second.push_back(2 * chain.n + 1 + side);
  }
  const std::vector<int> pins{1, 2 * chain.n + 16, 5 * chain.n - 2};
  Poser poser = chain.poser(pins);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-4.0, 8.0);
  for (int i = 0; i < 1000; ++i) {
    Points targets(3, 2);
    for (double& value : targets.reshaped()) value = place(random);
    poser.move(targets);
    ASSERT_EQ(poser.report().flipped, 0) << i;
    ASSERT_TRUE(poser.positions().allFinite()) << i;
    if (i % 100 == 0) poser.reset();
  }
  Points targets = rows_of(chain.shape.vertices, pins);
  targets.row(2) += Eigen::RowVector2d(-0.5, 0.5);
  poser.move(targets);
  poser.settle();
  EXPECT_LT(widest_gap(poser.positions(), chain.joints), 1e-3 * 5.0);
}

/// The sum that Hold minimises does not fall whichever way vertices are moved from where it settles: by the
/// rest energy and springs as the header gives them, of a mesh posed with joints inside triangles.
TEST(PoserJoints, SettleWhereTheSumOfEnergiesIsLeast) {
  const Shape shape = joined(grid(4), moved(grid(4, 7), 0.8, 0.1));
  const Handles first = inside(shape, {5, 11}), second = inside(shape, {20, 25}, 0.5, 0.2);
  const double weight = 2.0;
  const Eigen::VectorXd stiffness = Eigen::VectorXd::LinSpaced(shape.triangles.rows(), 0.3, 3.0);
  Poser poser(shape.vertices, shape.triangles, {.stiffness = stiffness});
  poser.set_joints(first, second, Eigen::Vector2d(1.0, weight));
  const Handles pins = at(shape, {0, 3, 31});
  poser.set_handles(pins);
  Points targets = pins.positions(shape.vertices);
  targets.row(2) += Eigen::RowVector2d(0.3, 0.4);
  poser.move(targets);
  poser.settle();
  const auto energy = [&](const Points& x) {
    double sum = Poser::default_pin_weight * (pins.positions(x) - targets).squaredNorm();
    const Points gap = first.positions(x) - second.positions(x);
    sum += Poser::joint_weight * (gap.row(0).squaredNorm() + weight * gap.row(1).squaredNorm());
    for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
      const auto corner = shape.triangles.row(t);
      const auto sides = [&](const Points& at) {
        return (Eigen::Matrix2d() << (at.row(corner[1]) - at.row(corner[0])).transpose(),
                (at.row(corner[2]) - at.row(corner[0])).transpose())
            .finished();
      };
      const Eigen::Matrix2d rest = sides(shape.vertices), jacobian = sides(x) * rest.inverse();
      sum += stiffness[t] * 0.5 * std::abs(rest.determinant()) *
             (jacobian.squaredNorm() + jacobian.inverse().squaredNorm());
    }
    return sum;
  };
  const Points posed = poser.positions();
  const double least = energy(posed);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points way = 1e-3 * random_points(posed.rows(), seed);
    EXPECT_GT(energy(posed + way), least);
    EXPECT_NEAR(energy(posed + 1e-2 * way) - energy(posed - 1e-2 * way), 0.0, 1e-6 * least);
  }
}

TEST(PoserJoints, CanBeReplacedAndTakenAway) {
  const Chain chain(2);
  const std::vector<int> pins{1, 16};
  Poser poser = chain.poser(pins);
  const Points up = rows_of(chain.shape.vertices, pins).rowwise() + Eigen::RowVector2d(0.0, 1.0);
  poser.move(up);
  EXPECT_LT((poser.positions().rowwise() - Eigen::RowVector2d(0.0, 1.0) - chain.shape.vertices).norm(), 1e-9);
  poser.set_joints(at(chain.shape, {}), at(chain.shape, {}));
  const Points before = poser.positions();
  poser.move(rows_of(chain.shape.vertices, pins));
  EXPECT_EQ(poser.positions().bottomRows(chain.n), before.bottomRows(chain.n));
  EXPECT_LT(largest_difference(poser.positions().topRows(chain.n), chain.shape.vertices.topRows(chain.n)),
            1e-9);
}

TEST(PoserJoints, RefuseWhatTheyCannotBe) {
  const Chain chain(2);
  const Shape& shape = chain.shape;
  Poser poser = chain.poser({1, 16});
  Handles outside = at(shape, {chain.n});
  outside.vertices(0, 0) = 500;
  EXPECT_REFUSAL(poser.set_joints(at(shape, {1}), outside), "second, row 0: vertex 500 is out of range");
  EXPECT_REFUSAL(poser.set_joints(at(shape, {1}), at(shape, {4})), "second, row 0: on the same part");
  EXPECT_REFUSAL(poser.set_joints(at(shape, {1, 4}), at(shape, {chain.n})), "second has 1 rows");
  EXPECT_REFUSAL(poser.set_joints(at(shape, {1}), at(shape, {chain.n}), Eigen::VectorXd::Zero(1)),
                 "strength");
  for (const PoserMethod method : {PoserMethod::akvf, PoserMethod::arap}) {
    Poser other(shape.vertices, shape.triangles, {.method = method});
    EXPECT_REFUSAL(other.set_joints(at(shape, {1}), at(shape, {chain.n})), "only method hold");
  }
  // Those of before still hold.
  poser.move(rows_of(shape.vertices, {1, 16}).rowwise() + Eigen::RowVector2d(0.5, 0.0));
  EXPECT_LT(widest_gap(poser.positions(), chain.joints), 1e-9);
}

/// A drawn character cut into a trunk and what is below and above it, each overlapping the trunk, and held
/// there by patches: posed as the whole one.
class CutCharacter : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(CutCharacter, PosesAsOne) {
  const auto [folder, name] = GetParam();
  const auto read = characters::read(folder, name);
  if (!read) GTEST_SKIP() << "no " << name << " in " << folder;
  const auto n = static_cast<int>(read->vertices.rows());
  const Eigen::VectorXd height = read->vertices.col(1);
  const double low = height.minCoeff(), span = height.maxCoeff() - low;
  // Layers between shares of the height, one over the other by 6 % of it; vertex v of layer i is in `number`.
  Shape shape;
  std::vector<std::vector<int>> number(3, std::vector<int>(static_cast<std::size_t>(n), -1));
  std::vector<Eigen::RowVector2d> points;
  std::vector<Eigen::RowVector3i> corners;
  const std::array<std::array<double, 2>, 3> layers{{{-0.1, 0.36}, {0.30, 0.70}, {0.64, 1.1}}};
  for (std::size_t layer = 0; layer < 3; ++layer) {
    for (const auto& triangle : read->triangles.rowwise()) {
      const double middle = (height[triangle[0]] + height[triangle[1]] + height[triangle[2]]) / 3.0;
      const double share = (middle - low) / span;
      if (share < layers[layer][0] || share > layers[layer][1]) continue;
      Eigen::RowVector3i row;
      for (int c = 0; c < 3; ++c) {
        int& vertex = number[layer][static_cast<std::size_t>(triangle[c])];
        if (vertex < 0) {
          vertex = static_cast<int>(points.size());
          points.push_back(read->vertices.row(triangle[c]));
        }
        row[c] = vertex;
      }
      corners.push_back(row);
    }
  }
  shape.vertices.resize(static_cast<Eigen::Index>(points.size()), 2);
  shape.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    shape.vertices.row(static_cast<Eigen::Index>(i)) = points[i];
  for (std::size_t i = 0; i < corners.size(); ++i)
    shape.triangles.row(static_cast<Eigen::Index>(i)) = corners[i];
  Joints joints;
  for (std::size_t v = 0; v < static_cast<std::size_t>(n); ++v) {
    for (const std::size_t layer : {0U, 1U}) {
      if (number[layer][v] < 0 || number[layer + 1][v] < 0) continue;
      joints.first.push_back(number[layer][v]);
      joints.second.push_back(number[layer + 1][v]);
    }
  }
  const characters::Pose& pose = read->poses.at(0);
  std::vector<int> pins;
  for (const int v : pose.handles) {
    for (const std::size_t layer : {1U, 0U, 2U}) {
      if (number[layer][static_cast<std::size_t>(v)] < 0) continue;
      pins.push_back(number[layer][static_cast<std::size_t>(v)]);
      break;
    }
  }
  Poser poser(shape.vertices, shape.triangles), whole(read->vertices, read->triangles);
  poser.set_joints(at(shape, joints.first), at(shape, joints.second));
  poser.set_handles(at(shape, pins));
  whole.set_handles(at({read->vertices, read->triangles}, pose.handles));
  for (int i = 1; i <= 20; ++i) {
    const Points targets = pose.start + (pose.targets - pose.start) * (i / 20.0);
    poser.move(targets);
    whole.move(targets);
    EXPECT_EQ(poser.report().flipped, 0);
  }
  const Points posed = poser.settle(), expected = whole.settle();
  EXPECT_TRUE(poser.report().converged);
  EXPECT_LT(widest_gap(posed, joints), 1e-3 * read->diagonal());
  double furthest = 0.0;
  for (std::size_t layer = 0; layer < 3; ++layer) {
    for (int v = 0; v < n; ++v) {
      const int copy = number[layer][static_cast<std::size_t>(v)];
      if (copy >= 0) furthest = std::max(furthest, (posed.row(copy) - expected.row(v)).norm());
    }
  }
  EXPECT_LT(furthest, 0.05 * read->diagonal());  // what is double is stiffer
}

INSTANTIATE_TEST_SUITE_P(Characters, CutCharacter,
                         ::testing::Values(std::pair{PLANAR_OWN_CHARACTERS, "fox"},
                                           std::pair{PLANAR_TEST_DATA, "giraffe"},
                                           std::pair{PLANAR_TEST_DATA, "horse"}),
                         [](const auto& found) { return std::string(found.param.second); });

}  // namespace
}  // namespace planar::testing
