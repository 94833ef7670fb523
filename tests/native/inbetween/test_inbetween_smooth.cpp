// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "inbetween/inbetween_support.h"
#include "inbetween/key_slopes.h"
#include "planar/distortion.h"

/// Motions through more than two keys with option smooth, and beyond the outermost ones.
namespace planar::testing {
namespace {

constexpr double h = 1e-5;  // of the differences that stand for velocities

/// The largest jump of a vertex's velocity at the key at `time`, and its largest velocity there.
std::pair<double, double> jump_at(const Inbetweens& motion, double time) {
  const Points before = (motion.at(time) - motion.at(time - h)) / h,
               after = (motion.at(time + h) - motion.at(time)) / h;
  return {largest_difference(before, after), after.rowwise().norm().maxCoeff()};
}

TEST(KeySlopes, AreLimitedAndMeetTheKeysWithoutAnOffset) {
  EXPECT_DOUBLE_EQ(slope_through_key(2.0, 2.0, {1.0, 5.0}), 2.0);
  EXPECT_DOUBLE_EQ(slope_through_key(1.0, 3.0, {1.0, 1.0}), 1.5);
  EXPECT_EQ(slope_through_key(1.0, -3.0, {1.0, 1.0}), 0.0);
  EXPECT_EQ(slope_through_key(0.0, 3.0, {1.0, 1.0}), 0.0);
  EXPECT_LE(slope_through_key(1.0, 1e6, {5.0, 1.0}), 3.0);
  const Complex turned = slope_through_key(Complex(2.0, 0.0), Complex(0.0, 2.0), {1.0, 1.0});
  EXPECT_LT(std::abs(turned - Complex(1.0, 1.0)), 1e-15);
  EXPECT_EQ(slope_through_key(Complex(2.0), Complex(0.0), {1.0, 1.0}), Complex(0.0));
  const SlopeChange<double> change{0.7, -0.4};
  EXPECT_EQ(change.at(0.0), 0.0);
  EXPECT_EQ(change.at(1.0), 0.0);
  for (const double step : {h, -h}) {
    EXPECT_NEAR(change.at(step) / step, 0.7, 2e-5);
    EXPECT_NEAR(change.at(1.0 + step) / step, -0.4, 2e-5);
  }
}

TEST(Smooth, VelocitiesAreContinuousAtTheKeys) {
  for (const AnchorPath path : {AnchorPath::straight, AnchorPath::arc}) {
    Sequence s = bent();
    s.options.anchor_path = path;
    s.options.turns = (Eigen::MatrixXi(3, 2) << 0, 1, 0, 1, -1, 2).finished();
    const Inbetweens smooth = s.solved();
    s.options.smooth = false;
    const Inbetweens plain = s.solved();
    for (const double time : {1.0, 1.5}) {
      const auto [jump, velocity] = jump_at(smooth, time);
      EXPECT_LT(jump, 1e-3 * velocity) << time;  // accelerations times h
      EXPECT_GT(jump_at(plain, time).first, 0.3 * velocity) << time;
    }
    for (std::size_t k = 0; k < s.keys.size(); ++k) {
      EXPECT_EQ(smooth.at(s.options.key_times[static_cast<Eigen::Index>(k)]), s.keys[k]);
    }
  }
}

/// Only ratios of times count, as long as they are numbers.
TEST(Smooth, KeysMayBeAsNearInTimeAsNumbersAre) {
  Sequence s = bent();
  const Eigen::VectorXd times = s.options.key_times;
  const Points middle = s.solved().at(0.5 * (times[0] + times[1]));
  for (const double unit : {1e-200, 1e-300, 1e200, 1e307}) {
    s.options.key_times = unit * times;
    // Times are rounded to sixteen digits.
    EXPECT_LT(largest_difference(s.solved().at(0.5 * unit * (times[0] + times[1])), middle), 1e-12) << unit;
  }
  s.options.key_times << 0.0, 1e-300, 1.0, 2.0;
  const Inbetweens uneven = s.solved();
  for (const double time : {5e-301, 1e-299, 0.5, 1.5}) EXPECT_TRUE(uneven.at(time).allFinite()) << time;
}

TEST(Smooth, EdgesWithoutFacesAreSmoothToo) {
  const int n = 30;
  Points line(n, 2);
  for (int i = 0; i < n; ++i) line.row(i) << static_cast<double>(i) / (n - 1), 0.0;
  InbetweenOptions options;
  options.smooth = true;
  const Inbetweens motion({line, rolled(line, 1.0), rolled(line, 4.0)}, contour(n, true), options);
  const auto [jump, velocity] = jump_at(motion, 1.0);
  EXPECT_LT(jump, 1e-3 * velocity);
}

TEST(Smooth, WhatIsHeldStaysAndIsLeftFromRest) {
  Sequence s = bent();
  s.keys[2] = s.keys[1];
  const Inbetweens motion = s.solved();
  for (const double time : {1.1, 1.25, 1.4}) EXPECT_LT(largest_difference(motion.at(time), s.keys[1]), 1e-12);
  for (const double time : {1.0 - h, 1.5 + h}) {
    EXPECT_LT(largest_difference(motion.at(time), s.keys[1]), 1e-2 * h) << time;
  }
}

/// About a far pivot by arcs: at one speed it is that rotation; at changing ones it still is a rotation about
/// the pivot.
TEST(Smooth, RotationsAboutAPivotStayOnTheirCircle) {
  const Shape shape = grid(5);
  const auto at_angle = [&](double angle) {
    return rigid_motion(moved(shape, 4.0, 1.0).vertices, angle, 0.0, 0.0);
  };
  InbetweenOptions options;
  options.smooth = true;
  options.anchor_path = AnchorPath::arc;
  options.key_times = Eigen::Vector4d(0.0, 1.0, 1.5, 4.0);
  const auto solved = [&](const Eigen::Vector4d& angles) {
    return Inbetweens({at_angle(angles[0]), at_angle(angles[1]), at_angle(angles[2]), at_angle(angles[3])},
                      shape.triangles, options);
  };
  const Inbetweens uniform_speed = solved(0.4 * options.key_times);
  for (const double time : {0.3, 1.2, 1.5, 3.1}) {
    EXPECT_LT(largest_difference(uniform_speed.at(time), at_angle(0.4 * time)), 1e-9);
  }
  const Inbetweens faster = solved(Eigen::Vector4d(0.0, 0.2, 1.0, 2.2));
  double before = 0.0;
  for (const double time : {0.2, 0.5, 0.9, 1.1, 1.3, 1.7, 2.5, 3.9}) {
    const Points x = faster.at(time), first = at_angle(0.0);
    const double angle = std::arg(Complex(x(0, 0), x(0, 1)) / Complex(first(0, 0), first(0, 1)));
    EXPECT_LT(largest_difference(x, at_angle(angle)), 1e-9) << time;
    EXPECT_GT(angle, before);
    before = angle;
  }
  for (const double time : {1.0, 1.5}) {
    const auto [jump, velocity] = jump_at(faster, time);
    EXPECT_LT(jump, 1e-3 * velocity);
  }
}

TEST(Smooth, ReversedKeysGiveReversedFrames) {
  Sequence s = bent();
  const Inbetweens forward = s.solved();
  std::reverse(s.keys.begin(), s.keys.end());
  s.options.key_times = (4.0 - s.options.key_times.array()).reverse().eval();
  const Inbetweens back = s.solved();
  for (const double time : {0.4, 1.2, 2.0, 3.9}) {
    EXPECT_LT(largest_difference(forward.at(time), back.at(4.0 - time)), 1e-9);
  }
}

TEST(Smooth, AMotionsOwnFrameAsOneMoreKeyHardlyChangesIt) {
  const Shape shape = bar(60);
  const std::vector<Points> keys{shape.vertices, rolled(shape.vertices, 300.0 * degrees)};
  const auto frames = inbetween(keys, uniform(25), shape.triangles);
  InbetweenOptions options;
  options.smooth = true;
  options.key_times = Eigen::Vector3d(0.0, 10.0, 24.0);
  const auto again = inbetween({keys[0], frames[10], keys[1]}, uniform(25, 24.0), shape.triangles, options);
  double path = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) path += largest_difference(frames[i], frames[i - 1]);
  EXPECT_LT(largest_difference(frames, again), 0.02 * path);
}

TEST(Anchors, CanDifferFromTransitionToTransition) {
  Sequence s = bent();
  s.options.smooth = false;
  s.options.anchors = {Eigen::Vector2i(3, 60), Eigen::VectorXi(), Eigen::VectorXi::Constant(1, 8)};
  const Inbetweens motion = s.solved();
  const auto middle = [&](int a, int b, const Points& x) { return ((x.row(a) + x.row(b)) / 2.0).eval(); };
  EXPECT_LT((motion.at(0.3).row(3) - 0.7 * s.keys[0].row(3) - 0.3 * s.keys[1].row(3)).norm(), 1e-12);
  EXPECT_LT((motion.at(0.3).row(60) - 0.7 * s.keys[0].row(60) - 0.3 * s.keys[1].row(60)).norm(), 1e-12);
  EXPECT_LT(
      (motion.at(1.25).topRows(51).colwise().mean() -
       middle(0, 1,
              (Points(2, 2) << s.keys[1].topRows(51).colwise().mean(), s.keys[2].topRows(51).colwise().mean())
                  .finished()))
          .norm(),
      1e-12);
  EXPECT_LT((motion.at(2.75).row(8) - (s.keys[2].row(8) + s.keys[3].row(8)) / 2.0).norm(), 1e-12);
}

/// A foot is planted up to the key, the other one from it on: neither may slip, smooth or not.
TEST(Anchors, PlantedOnesStayPlantedIfSmooth) {
  Sequence s = bent();
  s.keys.pop_back();
  for (std::size_t k = 1; k < 3; ++k) {
    const int foot = k == 1 ? 0 : 48;
    s.keys[k].topRows(51).rowwise() += (s.keys[k - 1].row(foot) - s.keys[k].row(foot)).eval();
  }
  s.options.key_times = Eigen::Vector3d(0.0, 1.0, 1.5);
  s.options.anchors = {Eigen::VectorXi::Constant(1, 0), Eigen::VectorXi::Constant(1, 48)};
  const Inbetweens motion = s.solved();
  for (const double time : {0.3, 0.9, 0.99}) {
    EXPECT_LT((motion.at(time).row(0) - s.keys[0].row(0)).norm(), 1e-12);
  }
  for (const double time : {1.01, 1.2, 1.45}) {
    EXPECT_LT((motion.at(time).row(48) - s.keys[1].row(48)).norm(), 1e-12);
  }
}

TEST(Anchors, AreCheckedSetBySet) {
  Sequence s = bent();
  s.options.anchors = {Eigen::VectorXi(), Eigen::VectorXi()};
  EXPECT_REFUSAL(s.solved(), "anchor: 2 sets, expected 1 or 3");
  s.options.anchors = {Eigen::VectorXi(), Eigen::Vector2i(1, 68), Eigen::VectorXi()};
  EXPECT_REFUSAL(s.solved(), "anchor[1], row 1: vertex 68");
}

/// A figure of three layers: an arm that swings about the body's shoulder, a hand at its end.
struct Layers {
  Layers() {
    const Shape layers = joined(joined(grid(5), moved(bar(10), 0.9, 0.8)), moved(bar(6), 1.9, 0.8));
    s.shape = layers;
    s.options.joints = {(Edges(2, 2) << 56, 59, 24, 25).finished()};  // the hand's first, before its carrier
    const auto key = [&](double body, double arm, double hand) {
      Points p = rigid_motion(layers.vertices, body, 2.0 * body, 0.3);
      swing(p, 25, 54, 24, 25, arm);
      swing(p, 58, 21, 56, 59, hand);
      return p;
    };
    s.keys = {key(0.0, 0.0, 0.0), key(0.4, 1.3, 0.8), key(0.2, 2.4, -0.5)};
    s.keys[1].row(24) += Eigen::RowVector2d(0.01, 0.0);  // the shoulder gives a little
  }

  /// Turns the rows from `first` about vertex b and takes them to vertex a.
  static void swing(Points& p, int first, int rows, int a, int b, double angle) {
    const Eigen::RowVector2d to = p.row(a), from = p.row(b);
    p.middleRows(first, rows) =
        rigid_motion(p.middleRows(first, rows).rowwise() - from, angle, to.x(), to.y());
  }

  Sequence s;
};

TEST(Joints, KeepLayersTogether) {
  const Layers layers;
  const Inbetweens motion = layers.s.solved();
  for (const double time : {0.25, 0.5, 0.9, 1.3, 1.8}) {
    const Points x = motion.at(time);
    EXPECT_LT((x.row(56) - x.row(59)).norm(), 1e-12) << time;
    // Straight from none to .01 and back.
    EXPECT_NEAR((x.row(24) - x.row(25)).norm(), 0.01 * (1.0 - std::abs(1.0 - time)), 1e-12) << time;
    // The body keeps to its own anchor.
    const auto k = static_cast<std::size_t>(time);
    const double u = time - static_cast<double>(k);
    const Points linear = (1.0 - u) * layers.s.keys[k] + u * layers.s.keys[k + 1];
    EXPECT_LT((x.topRows(25).colwise().mean() - linear.topRows(25).colwise().mean()).norm(), 1e-12);
  }
  EXPECT_GT(jump_at(motion, 1.0).first, 0.1);
}

TEST(Joints, KeepLayersTogetherIfSmooth) {
  Layers layers;
  layers.s.options.smooth = true;
  const Inbetweens motion = layers.s.solved();
  for (const double time : {0.25, 0.9, 1.3}) {
    const Points x = motion.at(time);
    EXPECT_LT((x.row(56) - x.row(59)).norm(), 1e-12) << time;
    EXPECT_LT((x.row(24) - x.row(25)).norm(), 0.01) << time;
  }
  const auto [jump, velocity] = jump_at(motion, 1.0);
  EXPECT_LT(jump, 1e-3 * velocity);
}

TEST(Joints, AreCheckedSetBySet) {
  const auto refused = [](const Edges& rows) {
    Layers layers;
    layers.s.options.joints = {Edges(), rows};
    return layers.s;
  };
  EXPECT_REFUSAL(refused((Edges(1, 2) << 3, 900).finished()).solved(), "joints[1], row 0: vertex 900");
  EXPECT_REFUSAL(refused((Edges(1, 2) << 3, 4).finished()).solved(),
                 "joints[1], row 0: the part would carry itself");
  EXPECT_REFUSAL(refused((Edges(2, 2) << 3, 30, 60, 30).finished()).solved(),
                 "row 1: the part is carried by another");
  EXPECT_REFUSAL(refused((Edges(3, 2) << 3, 30, 30, 60, 60, 3).finished()).solved(),
                 "row 2: the part would carry itself");
  Sequence s = bent();
  s.options.joints = {(Edges(1, 2) << 3, 67).finished()};
  EXPECT_REFUSAL(s.solved(), "belongs to no part");
}

class Overshoot : public ::testing::TestWithParam<bool> {};

TEST_P(Overshoot, GoesOnSmoothlyBeyondTheKeys) {
  Sequence s = bent();
  s.options.smooth = GetParam();
  const Inbetweens motion = s.solved();
  for (const double time : {0.0, 4.0}) {
    const auto at = [&](double t) { return motion.at(t, Outside::extrapolate); };
    const Points before = (at(time) - at(time - h)) / h, after = (at(time + h) - at(time)) / h;
    EXPECT_LT(largest_difference(before, after), 1e-3 * after.rowwise().norm().maxCoeff()) << time;
  }
  // Rigid motions and bending go on; sides keep about their length.
  for (const double time : {-1.0, -0.5, 5.0, 6.5}) {
    const Points x = motion.at(time, Outside::extrapolate);
    EXPECT_TRUE(x.allFinite());
    EXPECT_LT(distortion(s.shape.vertices, x, s.shape.triangles).area, 2.2) << time;
  }
  EXPECT_EQ(motion.at(4.0, Outside::extrapolate), s.keys[3]);
  EXPECT_REFUSAL(motion.at(-0.5), "times, row 0: outside of the keys' times");
  EXPECT_REFUSAL(motion.at(-1.1, Outside::extrapolate), "by more than");
  EXPECT_REFUSAL(motion.at(6.6, Outside::extrapolate), "by more than");
}

INSTANTIATE_TEST_SUITE_P(PlainAndSmooth, Overshoot, ::testing::Bool());

TEST(Overshoot, ContinuesARotation) {
  const Shape shape = grid(5);
  InbetweenOptions options;
  options.anchor_path = AnchorPath::arc;
  const Inbetweens motion({shape.vertices, rigid_motion(shape.vertices, 1.0, 0.0, 0.0)}, shape.triangles,
                          options);
  for (const double time : {-1.0, -0.2, 1.3, 2.0}) {
    EXPECT_LT(largest_difference(motion.at(time, Outside::extrapolate),
                                 rigid_motion(shape.vertices, time, 0.0, 0.0)),
              1e-9);
  }
}

TEST(Overshoot, OfKeysWithoutAreaIsFinite) {
  const Shape shape = grid(4);
  const Points point = Points::Zero(16, 2);
  for (const std::vector<Points>& keys :
       {std::vector<Points>{shape.vertices, point}, {point, shape.vertices}}) {
    const Inbetweens motion(keys, shape.triangles);
    for (const double time : {-1.0, 2.0}) EXPECT_TRUE(motion.at(time, Outside::extrapolate).allFinite());
  }
}

}  // namespace
}  // namespace planar::testing
