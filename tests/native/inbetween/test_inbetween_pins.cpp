// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "characters.h"
#include "inbetween/inbetween_support.h"
#include "planar/distortion.h"
#include "planar/poser.h"

/// Pins that are held on their ways from key to key.
namespace planar::testing {
namespace {

using Pinned = decltype(InbetweenOptions::pinned);

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

InbetweenOptions with_pins(const Shape& shape, const std::vector<int>& vertices) {
  InbetweenOptions options;
  options.pins = at(shape, vertices);
  return options;
}

InbetweenOptions with_patch(const Shape& shape, const std::vector<int>& vertices) {
  InbetweenOptions options = with_pins(shape, vertices);
  options.pin_groups = Eigen::VectorXi::Zero(static_cast<Eigen::Index>(vertices.size()));
  return options;
}

Points between(const Points& from, const Points& to, double u) { return from + u * (to - from); }

/// Of all vertices between each frame and the next two.
double second_difference(const std::vector<Points>& frames) {
  double largest = 0.0;
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    largest = std::max(largest, largest_difference(frames[i + 1] + frames[i - 1], 2.0 * frames[i]));
  }
  return largest;
}

TEST(InbetweenPins, WhatTurnsAboutAPinThatStandsDoesSo) {
  const Shape shape = bar(20);
  for (const int pin : {0, 31}) {
    const Eigen::RowVector2d centre = shape.vertices.row(pin);
    const auto turned = [&](double angle) -> Points {
      return rigid_motion(shape.vertices.rowwise() - centre, angle, 0.0, 0.0).rowwise() + centre;
    };
    const auto frames =
        inbetween({shape.vertices, turned(2.0)}, uniform(9), shape.triangles, with_pins(shape, {pin}));
    for (int i = 0; i < 9; ++i) {
      EXPECT_LT(largest_difference(frames[static_cast<std::size_t>(i)], turned(0.25 * i)), 1e-9);
    }
  }
}

TEST(InbetweenPins, OnePinGoesStraightAndTheRestTurnsAboutIt) {
  const Shape shape = bar(20);
  const Points to = rigid_motion(shape.vertices, -1.5, 0.7, 0.3);
  const Points half = inbetween({shape.vertices, to}, uniform(3), shape.triangles, with_pins(shape, {5}))[1];
  const Points turned = rigid_motion(shape.vertices, -0.75, 0.0, 0.0);
  const Eigen::RowVector2d way = 0.5 * (shape.vertices.row(5) + to.row(5)) - turned.row(5);
  EXPECT_LT(largest_difference(half, turned.rowwise() + way), 1e-9);
}

/// A bar that stands on both of its ends while its middle, pushed up in one key and down in the other,
/// swings.
TEST(InbetweenPins, BothEndsStandWhileTheMiddleSwings) {
  const Shape shape = bar(30);
  const std::vector<int> ends{1, 91};
  Poser poser(shape.vertices, shape.triangles);
  poser.set_handles(at(shape, {1, 46, 91}));
  const auto pushed = [&](double by) {
    poser.move((Points(3, 2) << 0.0, 0.0, 0.5, by, 1.0, 0.0).finished());
    return poser.settle();
  };
  const std::vector<Points> keys{pushed(0.06), pushed(-0.05)};
  const InbetweenOptions options = with_pins(shape, ends);
  double drift = 0.0;
  for (const bool held : {false, true}) {
    const auto frames = inbetween(keys, uniform(33), shape.triangles, held ? options : InbetweenOptions{});
    double off = 0.0;
    for (int i = 0; i < 33; ++i) {
      const Points places =
          between(options.pins.positions(keys[0]), options.pins.positions(keys[1]), i / 32.0);
      off = std::max(off,
                     largest_difference(options.pins.positions(frames[static_cast<std::size_t>(i)]), places));
    }
    if (held) {
      EXPECT_LT(off, 1e-6);
    } else {
      drift = off;
    }
  }
  EXPECT_GT(drift, 1e-4);  // there was something to hold
}

/// Drawn characters posed with two of their handles standing: the feet of a step.
class PinnedCharacter : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  void SetUp() override {
    const auto [folder, name] = GetParam();
    const auto read = characters::read(folder, name);
    if (!read) {
      ASSERT_STRNE(folder, PLANAR_OWN_CHARACTERS);
      GTEST_SKIP() << "no " << name << " in " << folder;
    }
    shape = {read->vertices, read->triangles};
    diagonal = read->diagonal();
    for (const characters::Pose& pose : read->poses) {
      std::vector<int> order(pose.handles.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
      const Eigen::VectorXd way = (pose.targets - pose.start).rowwise().norm();
      std::sort(order.begin(), order.end(), [&](int a, int b) { return way[a] < way[b]; });
      Points targets = pose.targets;
      std::vector<int> feet;
      for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
        targets.row(order[i]) = pose.start.row(order[i]);
        feet.push_back(pose.handles[static_cast<std::size_t>(order[i])]);
      }
      Poser poser(shape.vertices, shape.triangles, {.pin_weight = 1e6});
      poser.set_handles(at(shape, pose.handles));
      for (int i = 1; i <= 20; ++i) poser.move(between(pose.start, targets, i / 20.0));
      keys.push_back(poser.settle());
      standing.push_back(feet);
    }
  }

  double distortion_of(const Points& x) const {
    const Distortion d = distortion(shape.vertices, x, shape.triangles);
    return d.area + d.angle;
  }

  Shape shape;
  double diagonal = 0.0;
  std::vector<Points> keys;
  std::vector<std::vector<int>> standing;
};

TEST_P(PinnedCharacter, StandsOnBothFeet) {
  for (std::size_t pose = 0; pose < keys.size(); ++pose) {
    const std::vector<Points> ends{shape.vertices, keys[pose]};
    InbetweenOptions plain, options = with_pins(shape, standing[pose]);
    plain.rest = options.rest = shape.vertices;
    const int last = 24;
    const auto before = inbetween(ends, uniform(last + 1), shape.triangles, plain);
    const auto frames = inbetween(ends, uniform(last + 1), shape.triangles, options);
    EXPECT_EQ(frames.front(), ends[0]);
    EXPECT_EQ(frames.back(), ends[1]);
    const Points stand = options.pins.positions(ends[0]);
    const double worse_end = std::max(distortion_of(ends[0]), distortion_of(ends[1]));
    for (const Points& frame : frames) {
      EXPECT_LT(largest_difference(options.pins.positions(frame), stand), 2e-4 * diagonal);
      EXPECT_LE(distortion_of(frame), 1.001 * worse_end);
      EXPECT_EQ(distortion(shape.vertices, frame, shape.triangles).flipped, 0);
    }
    // As smooth as without, and no jump beside a key: there it would be the largest.
    EXPECT_LT(second_difference(frames), 2.0 * second_difference(before) + 1e-6 * diagonal);
  }
}

INSTANTIATE_TEST_SUITE_P(Characters, PinnedCharacter,
                         ::testing::Values(std::pair{PLANAR_OWN_CHARACTERS, "fox"},
                                           std::pair{PLANAR_OWN_CHARACTERS, "dragon"},
                                           std::pair{PLANAR_TEST_DATA, "giraffe"}),
                         [](const auto& found) { return std::string(found.param.second); });

TEST(InbetweenPins, APatchThatStandsStaysFlat) {
  const Bending bending;
  const std::vector<int> foot{0, 1, 2, 3, 4, 5, 6, 7, 8};
  Poser poser(bending.shape.vertices, bending.shape.triangles, {.pin_weight = 1e6});
  std::vector<int> held = foot;
  held.push_back(91);
  poser.set_handles(at(bending.shape, held));
  Points targets = poser.positions()(held, Eigen::all);
  for (int i = 1; i <= 20; ++i) {
    targets.row(9) = Eigen::RowVector2d(std::cos(0.08 * i), std::sin(0.08 * i)) * 0.9;
    poser.move(targets);
  }
  const Points to = poser.settle();  // the rest is bent
  const InbetweenOptions options = with_patch(bending.shape, foot);
  for (const Points& frame :
       inbetween({bending.shape.vertices, to}, uniform(17), bending.shape.triangles, options)) {
    EXPECT_LT(
        largest_difference(options.pins.positions(frame), options.pins.positions(bending.shape.vertices)),
        1e-6);
  }
}

/// The middle goes straight, the handles keep their distances, whole turns included.
TEST(InbetweenPins, APatchThatTurnsKeepsItsShape) {
  const Shape shape = bar(30);
  const std::vector<int> hand{84, 85, 86, 87, 88, 89, 90, 91, 92};
  const Points to = rigid_motion(rolled(shape.vertices, 200.0 * degrees), 0.2, 0.3, 0.1);
  for (const int turns : {0, 1}) {
    InbetweenOptions options = with_patch(shape, hand);
    options.turns = Eigen::MatrixXi::Constant(1, 1, turns);
    const Points first = options.pins.positions(shape.vertices), last = options.pins.positions(to);
    const double whole = (turns == 0 ? 0.0 : 2.0 * std::numbers::pi);
    double turned = 0.0;
    Points previous = first;
    for (const Points& frame : inbetween({shape.vertices, to}, uniform(41), shape.triangles, options)) {
      const Points x = options.pins.positions(frame);
      for (Eigen::Index i = 1; i < x.rows(); ++i) {
        const double a = (first.row(i) - first.row(0)).norm(), b = (last.row(i) - last.row(0)).norm();
        EXPECT_NEAR((x.row(i) - x.row(0)).norm(), a, std::abs(b - a) + 3e-3 * a);  // it bends a little
      }
      const auto side = [](const Points& p) { return Complex(p(8, 0) - p(0, 0), p(8, 1) - p(0, 1)); };
      turned += std::arg(side(x) / side(previous));
      previous = x;
    }
    // The bar's end turns by 200° and 0.2; of that, less than half a turn, it goes the way that the bar goes.
    EXPECT_NEAR(turned - whole, 200.0 * degrees + 0.2, 10.0 * degrees) << turns;
  }
}

TEST(InbetweenPins, GoOnGivenPaths) {
  const Bending bending;
  const std::vector<Points> keys{bending.frames.front(), bending.frames.back()};
  const InbetweenOptions options = with_pins(bending.shape, {0, 46, 91});
  const Points from = options.pins.positions(keys[0]), to = options.pins.positions(keys[1]);
  const Eigen::VectorXd times = uniform(9);
  const Inbetweens natural(keys, bending.shape.triangles), motion(keys, bending.shape.triangles, options);
  std::vector<Points> paths;
  for (const double time : times) {
    // As the bar would go, and a little to the side; the first pin as it likes.
    paths.push_back(options.pins.positions(natural.at(time)));
    paths.back().row(1).x() += 0.05 * std::sin(std::numbers::pi * time);
    paths.back().row(0).setConstant(nan);
  }
  const auto frames = motion.at(times, Outside::refuse, {}, paths);
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    Points wanted = paths[static_cast<std::size_t>(i)];
    wanted.row(0) = between(from, to, times[i]).row(0);
    EXPECT_LT(largest_difference(options.pins.positions(frames[static_cast<std::size_t>(i)]), wanted), 1e-5);
  }
  EXPECT_EQ(frames.front(), keys[0]);
  EXPECT_EQ(frames.back(), keys[1]);
  EXPECT_EQ(inbetween(keys, times, bending.shape.triangles, options, paths), frames);
  // A path that stays near the pin's own way leads into the keys without a jump.
  const double beside = 1e-7;
  const std::vector<Points> near{options.pins.positions(natural.at(beside))};
  EXPECT_LT(largest_difference(motion.at(Eigen::VectorXd::Constant(1, beside), Outside::refuse, {}, near)[0],
                               keys[0]),
            1e-5);
}

/// Two bars, the second hung on the first one's end.
struct Hung {
  Shape shape = joined(bar(20), moved(bar(20), 0.95, 0.02));
  int n = static_cast<int>(bar(20).vertices.rows());
  int carrier = 58, carried = n + 1;  ///< next to each other
  std::vector<Points> keys{shape.vertices, shape.vertices};

  Hung() {
    Points& to = keys[1];
    to.topRows(n) = rigid_motion(rolled(shape.vertices.topRows(n), 90.0 * degrees), 0.3, 0.1, 0.0);
    const Points arm = rigid_motion(shape.vertices.bottomRows(n), 1.8, 0.0, 0.0);
    const Eigen::RowVector2d way = to.row(carrier) - arm.row(carried - n);
    to.bottomRows(n) = arm.rowwise() + (way + shape.vertices.row(carried) - shape.vertices.row(carrier));
  }

  InbetweenOptions options(const std::vector<int>& pins) const {
    InbetweenOptions result = with_pins(shape, pins);
    result.joints = {(Edges(1, 2) << carrier, carried).finished()};
    return result;
  }

  Eigen::RowVector2d offset(const Points& x) const { return x.row(carried) - x.row(carrier); }
};

TEST(InbetweenPins, WhatIsCarriedComesAlong) {
  const Hung hung;
  const auto plain = inbetween(hung.keys, uniform(9), hung.shape.triangles, hung.options({}));
  const std::vector<int> feet{1, 40}, both{1, 40, hung.n + 61};
  for (const std::vector<int>& pins : {feet, both}) {
    const InbetweenOptions options = hung.options(pins);
    const auto frames = inbetween(hung.keys, uniform(9), hung.shape.triangles, options);
    const Points from = options.pins.positions(hung.keys[0]), to = options.pins.positions(hung.keys[1]);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const double u = static_cast<double>(i) / 8.0;
      EXPECT_LT(largest_difference(options.pins.positions(frames[i]), between(from, to, u)), 1e-4);
      const Eigen::RowVector2d wanted = (1.0 - u) * hung.offset(hung.keys[0]) + u * hung.offset(hung.keys[1]);
      EXPECT_LT((hung.offset(frames[i]) - wanted).norm(), 1e-5);
      if (pins.size() > feet.size()) continue;
      const Points before = plain[i].bottomRows(hung.n), after = frames[i].bottomRows(hung.n);
      EXPECT_LT(largest_difference(after, before.rowwise() + (after.row(0) - before.row(0))), 1e-12);
    }
  }
}

TEST(InbetweenPins, PassAKeySmoothly) {
  const Shape shape = bar(30);
  const Points middle = rigid_motion(rolled(shape.vertices, 60.0 * degrees), 0.3, 0.1, 0.05);
  const Points last = rigid_motion(rolled(shape.vertices, 100.0 * degrees), 0.9, 0.5, 0.1);
  InbetweenOptions options = with_pins(shape, {1, 84, 85, 86, 87, 88, 89, 90, 91, 92});
  options.pin_groups = Eigen::VectorXi::Ones(10);
  options.pin_groups[0] = 0;
  options.key_times = Eigen::Vector3d(0.0, 1.0, 3.0);
  for (const bool smooth : {true, false}) {
    options.smooth = smooth;
    const Inbetweens motion({shape.vertices, middle, last}, shape.triangles, options);
    const double step = 1e-3;
    const Points before = motion.at(1.0 - step), after = motion.at(1.0 + step);
    const double kink = largest_difference(after + before, 2.0 * middle) / largest_difference(after, before);
    if (smooth) {
      EXPECT_LT(kink, 0.02);
    } else {
      EXPECT_GT(kink, 0.1);
    }
  }
}

TEST(InbetweenPins, AreHeldOnlyBetweenTheKeysThatAreSaid) {
  const Shape shape = bar(20);
  const std::vector<Points> keys{shape.vertices, rolled(shape.vertices, 80.0 * degrees),
                                 rigid_motion(rolled(shape.vertices, -40.0 * degrees), 1.0, 0.4, 0.0)};
  InbetweenOptions options = with_pins(shape, {1, 61});
  options.pinned = (Pinned(2, 2) << true, true, false, false).finished();
  const auto frames = inbetween(keys, uniform(17, 2.0), shape.triangles, options);
  const auto plain = inbetween(keys, uniform(17, 2.0), shape.triangles);
  for (std::size_t i = 8; i < frames.size(); ++i) EXPECT_EQ(frames[i], plain[i]) << i;
  EXPECT_GT(largest_difference(frames[4], plain[4]), 1e-3);
}

TEST(InbetweenPins, DoNotDependOnThreadsNorOnTheOrderOfTimes) {
  const Bending bending;
  const std::vector<Points> keys{bending.frames.front(), bending.frames.back()};
  InbetweenOptions options = with_pins(bending.shape, {0, 46, 91});
  options.threads = 1;
  const auto frames = inbetween(keys, uniform(14), bending.shape.triangles, options);
  options.threads = 3;
  const Inbetweens motion(keys, bending.shape.triangles, options);
  auto reversed = motion.at(uniform(14).reverse().eval());
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(largest_difference(reversed, frames), 0.0);
  EXPECT_EQ(motion.at(uniform(14)[5]), frames[5]);
}

TEST(InbetweenPins, FollowTheDrawingHoweverItLies) {
  const Bending bending;
  const std::vector<Points> keys{bending.frames.front(), bending.frames.back()};
  const InbetweenOptions options = with_pins(bending.shape, {0, 46, 91});
  const Points half = inbetween(keys, uniform(3), bending.shape.triangles, options)[1];
  const auto placed = [](const Points& x) { return Points(300.0 * rigid_motion(x, 1.5707, 40.0, -7.0)); };
  const Points turned =
      inbetween({placed(keys[0]), placed(keys[1])}, uniform(3), bending.shape.triangles, options)[1];
  EXPECT_LT(largest_difference(turned, placed(half)), 300.0 * 1e-6);
}

TEST(InbetweenPins, CanBeCancelled) {
  const Bending bending;
  const std::vector<Points> keys{bending.frames.front(), bending.frames.back()};
  const Inbetweens motion(keys, bending.shape.triangles, with_pins(bending.shape, {0, 46, 91}));
  int calls = 0;
  const auto stop = [&calls](double) { return ++calls < 3; };
  EXPECT_THROW(motion.at(uniform(200), Outside::refuse, stop), Cancelled);
  EXPECT_EQ(calls, 3);
  calls = -100;
  EXPECT_EQ(motion.at(uniform(20), Outside::refuse, stop).size(), 20u);
}

TEST(InbetweenPins, GoOnBeyondTheKeys) {
  const Bending bending;
  const std::vector<Points> keys{bending.frames.front(), bending.frames.back()};
  const InbetweenOptions options = with_pins(bending.shape, {0, 46});
  const Inbetweens motion(keys, bending.shape.triangles, options);
  const Points from = options.pins.positions(keys[0]), to = options.pins.positions(keys[1]);
  for (const double time : {-0.1, 1.1}) {
    EXPECT_LT(largest_difference(options.pins.positions(motion.at(time, Outside::extrapolate)),
                                 between(from, to, time)),
              1e-4);
  }
}

TEST(InbetweenPins, TurnNothingOverWhereTheirWaysWould) {
  const Shape shape = bar(20);
  const Points to = rigid_motion(shape.vertices, std::numbers::pi, 1.0, 0.0);
  // Both ends exchange their places straight: half way they are in one place.
  InbetweenOptions options = with_pins(shape, {1, 61});
  for (const Points& frame : inbetween({shape.vertices, to}, uniform(8), shape.triangles, options)) {
    EXPECT_EQ(distortion(shape.vertices, frame, shape.triangles).flipped, 0);
  }
  // A path out of reach, one that turns the bar round, two on one point that ask for different places.
  options.pins = at(shape, {1, 61, 61});
  const Points stay = options.pins.positions(shape.vertices);
  Points away = stay, round = stay, apart = stay;
  away.row(0).x() = -50.0;
  round.row(0).x() = 2.0;
  apart.row(2).y() = 0.1;
  const auto frames = Inbetweens({shape.vertices, shape.vertices}, shape.triangles, options)
                          .at(uniform(5).segment(1, 3), Outside::refuse, {}, {away, round, apart});
  for (const Points& frame : frames) {
    EXPECT_TRUE(frame.allFinite());
    EXPECT_EQ(distortion(shape.vertices, frame, shape.triangles).flipped, 0);
  }
  EXPECT_NEAR(frames[2](61, 1), 0.05, 1e-4);
}

/// Vertices without faces, triangles without area, and a part that is turned over between the keys.
TEST(InbetweenPins, BearWhatIsUnusual) {
  Shape shape = joined(grid(4), moved(grid(3, 5), 3.0, 0.0));
  const auto loose = static_cast<int>(shape.vertices.rows());
  shape.vertices.conservativeResize(loose + 1, 2);
  shape.vertices.row(loose) << 7.0, 7.0;
  shape.triangles.conservativeResize(shape.triangles.rows() + 1, 3);
  shape.vertices.row(1) = shape.vertices.row(0);
  shape.triangles.bottomRows(1) << 0, 1, 4;
  Points to = shape.vertices;
  to.middleRows(16, 9).col(0) *= -1.0;
  to.row(loose) << 8.0, 9.0;
  const InbetweenOptions options = with_pins(shape, {0, 15, 16, 24, loose});
  for (const Points& frame : inbetween({shape.vertices, to}, uniform(6), shape.triangles, options)) {
    EXPECT_TRUE(frame.allFinite());
    EXPECT_LT((frame.row(15) - shape.vertices.row(15)).norm(), 1e-5);
  }
}

TEST(InbetweenPins, RefuseWhatTheyCannotBe) {
  const Bending bending;
  const std::vector<Points> keys{bending.frames.front(), bending.frames.back()};
  const Triangles& triangles = bending.shape.triangles;
  const InbetweenOptions good = with_pins(bending.shape, {0, 46});
  const auto motion = [&](const InbetweenOptions& options) { return Inbetweens(keys, triangles, options); };
  InbetweenOptions options = good;
  options.pins.vertices(1, 0) = 1000;
  EXPECT_REFUSAL(motion(options), "handles, row 1: vertex 1000 is out of range");
  options = good;
  options.pin_groups = Eigen::VectorXi::Zero(3);
  EXPECT_REFUSAL(motion(options), "pin_groups");
  options.pin_groups = Eigen::VectorXi::Zero(2);
  options.pinned = (Pinned(1, 2) << true, false).finished();
  EXPECT_REFUSAL(motion(options), "pinned, row 0: handles of one group");
  options.pinned = Pinned::Constant(2, 2, true);
  EXPECT_REFUSAL(motion(options), "pinned has 2 rows");
  options.pinned = Pinned::Constant(1, 3, true);
  EXPECT_REFUSAL(motion(options), "pinned has 3 columns, expected 2");
  options = good;
  options.method = InbetweenMethod::paper;
  EXPECT_REFUSAL(inbetween(keys, uniform(3), triangles, options), "pins: the paper's methods");
  EXPECT_REFUSAL(Inbetweens(keys, contour(static_cast<int>(keys[0].rows())), good), "give triangles");
  const Points places = good.pins.positions(keys[0]);
  const auto at_half = [&](const InbetweenOptions& given, const std::vector<Points>& paths) {
    return motion(given).at(Eigen::VectorXd::Constant(1, 0.5), Outside::refuse, {}, paths);
  };
  EXPECT_REFUSAL(at_half({}, {places}), "pin_paths: there are no pins");
  EXPECT_REFUSAL(at_half(good, {places, places}), "pin_paths has 2 rows");
  EXPECT_REFUSAL(at_half(good, {places.topRows(1)}), "pin_paths[0] has 1 row");
  Points endless = places;
  endless(1, 0) = std::numeric_limits<double>::infinity();
  EXPECT_REFUSAL(at_half(good, {endless}), "pin_paths[0], row 1: not a finite number");
}

}  // namespace
}  // namespace planar::testing
