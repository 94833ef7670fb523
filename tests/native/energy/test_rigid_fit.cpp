// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "energy/hinged_fit.h"
#include "energy/rigid_fit.h"
#include "support.h"

namespace planar::testing {
namespace {

/// Pairs of one part with weights from 0.5 to 1.5.
std::vector<PointPair> pairs_of(const Points& from, const Points& to) {
  std::vector<PointPair> pairs;
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    pairs.push_back({0, 0.5 + 0.5 * static_cast<double>(i % 3), Complex(from(i, 0), from(i, 1)),
                     Complex(to(i, 0), to(i, 1))});
  }
  return pairs;
}

RigidMotion fitted(const Points& from, const Points& to) {
  return fit_rigid_motions(1, pairs_of(from, to)).front();
}

TEST(RigidFit, FindsTheMotion) {
  const Points from = random_points(5, 1);
  for (const double angle : {0.0, 1e-9, 0.4, -3.0}) {
    const RigidMotion motion = fitted(from, rigid_motion(from, angle, 3.0, -1.0));
    EXPECT_NEAR(motion.angle, angle, 1e-14);
    EXPECT_LT(std::abs(motion.turn - std::polar(1.0, angle)), 1e-14);
    const Complex p(0.3, 0.2), q = std::polar(1.0, angle) * p + Complex(3.0, -1.0);
    EXPECT_LT(std::abs(motion.at(p) - q), 1e-14);
    EXPECT_LT(std::abs(motion.at(p, 1.0) - q), 1e-14);
    EXPECT_LT(std::abs(motion.at(p, 0.0) - p), 1e-14);
  }
}

TEST(RigidFit, IsTheBestOfAllMotions) {
  const Points from = random_points(6, 1), to = random_points(6, 2);
  const std::vector<PointPair> pairs = pairs_of(from, to);
  const auto error = [&](const RigidMotion& motion) {
    double sum = 0.0;
    for (const PointPair& pair : pairs) sum += pair.weight * std::norm(motion.at(pair.from) - pair.to);
    return sum;
  };
  const RigidMotion best = fitted(from, to);
  for (const Complex shift : {Complex(1e-3, 0.0), Complex(0.0, -1e-3)}) {
    RigidMotion other = best;
    other.to += shift;
    EXPECT_GT(error(other), error(best));
    other = best;
    other.turn *= std::polar(1.0, shift.real() + shift.imag());
    EXPECT_GT(error(other), error(best));
  }
}

TEST(RigidFit, PartsAreFittedApart) {
  const Points a = random_points(4, 1), b = random_points(4, 2);
  std::vector<PointPair> pairs = pairs_of(a, rigid_motion(a, 0.5, 1.0, 0.0));
  for (PointPair pair : pairs_of(b, rigid_motion(b, -0.7, 0.0, 2.0))) {
    pair.part = 2;
    pairs.insert(pairs.begin() + 2, pair);
  }
  const std::vector<RigidMotion> motions = fit_rigid_motions(4, pairs);
  EXPECT_NEAR(motions[0].angle, 0.5, 1e-14);
  EXPECT_NEAR(motions[2].angle, -0.7, 1e-14);
  for (const int none : {1, 3}) {
    EXPECT_EQ(motions[static_cast<std::size_t>(none)].at({0.3, 0.4}), Complex(0.3, 0.4));
    EXPECT_EQ(motions[static_cast<std::size_t>(none)].angle, 0.0);
  }
}

/// Nothing says how to turn: then nothing turns, not by a bit.
void expect_no_turn(const Points& from, const Points& to, const std::string& what) {
  const RigidMotion motion = fitted(from, to);
  EXPECT_EQ(motion.angle, 0.0) << what;
  EXPECT_EQ(motion.turn, Complex(1.0)) << what;
}

TEST(RigidFit, TurnsThatNothingDeterminesAreNone) {
  Points corners(4, 2);
  corners << -1, -1, 1, -1, -1, 1, 1, 1;
  Points mirrored = corners;
  mirrored.col(0) *= -1.0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const Points some = random_points(7, seed), others = random_points(7, seed + 5000);
    const std::string what = "seed " + std::to_string(seed);
    const double far = std::pow(10.0, static_cast<int>(seed % 6));
    expect_no_turn(some.topRows(1), far * others.topRows(1), what + ", one point");
    expect_no_turn(some.topRows(1).replicate(7, 1), far * others, what + ", points in one place");
    expect_no_turn(some, far * others.topRows(1).replicate(7, 1), what + ", targets in one place");
    // One point as three, each the sum of three products.
    Points same(3, 2);
    for (int i = 0; i < 3; ++i) {
      const double share = 0.1 * (i + 1), other_share = 0.3 - 0.05 * i;
      const Eigen::RowVector2d a = some.row(0), way = some.row(1);
      same.row(i) =
          share * (a + (1.0 - share) * way) + (1.0 - share) * (a - share * way) + other_share * (way - way);
    }
    expect_no_turn(same, others.topRows(3), what + ", one point as three");
    // Equal weights: three rows' weights differ, so each corner comes three times.
    const double angle = 0.01 * seed;
    const Points thrice = rigid_motion(corners.replicate(3, 1), angle, some(0, 0), some(0, 1));
    const Points targets = rigid_motion(mirrored.replicate(3, 1), 2.0 * angle, far, -far);
    expect_no_turn(thrice, targets, what + ", mirrored");
  }
}

TEST(RigidFit, NearPointsDetermineATurn) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Points place = random_points(1, seed);
    const Points from = (1e-6 * random_points(2, seed + 1000)).rowwise() + Eigen::RowVector2d(place.row(0));
    const double angle = 0.06 * seed - 3.0;
    // Coordinates of 1 that are rounded to 1e-16 give directions between points 1e-6 apart to 1e-10.
    const RigidMotion motion = fitted(from, rigid_motion(from, angle, 0.5, 0.1));
    EXPECT_NEAR(motion.angle, angle, 1e-8) << seed;
  }
}

/// The same motion of a part that returns nowhere in particular, by Newton steps.
TEST(HingedFit, OfOnePartIsTheRigidFit) {
  const Points from = random_points(6, 1), to = rigid_motion(random_points(6, 2), 0.3, 1.0, 2.0);
  const RigidMotion wanted = fitted(from, to);
  std::vector<Tie> ties;
  for (const PointPair& pair : pairs_of(from, to)) ties.push_back({0, -1, pair.weight, pair.from, pair.to});
  const Return part{1e-12, 1.0, 0.0, 0.0, 1.0, 1.0};
  const RigidMotion found = fit_hinged_motions({part}, ties, 1.0).front();
  EXPECT_LT(std::abs(found.turn - wanted.turn), 1e-5);
  for (const Complex p : {Complex(0.0), Complex(0.7, -0.2)}) {
    EXPECT_LT(std::abs(found.at(p) - wanted.at(p)), 1e-5);
  }
}

/// Two rods from 0 to 1 and from 1 to 2. The end of the second goes to where both have to bend, or the start
/// of the first stays and nothing else is asked: then the second returns to where it is.
TEST(HingedFit, TurnsRodsOnTheirHinge) {
  const auto rod = [](double middle) { return Return{1e-9, 10.0, middle, middle, 1.0, 1.0}; };
  const std::vector<Return> parts{rod(0.5), rod(1.5)};
  std::vector<Tie> ties{{0, -1, 1e3, 0.0, 0.0}, {0, 1, 1e4, 1.0, 1.0}};
  for (const RigidMotion& motion : fit_hinged_motions(parts, ties, 2.0)) {
    EXPECT_LT(std::abs(motion.at(0.4) - 0.4), 1e-12);
  }
  ties.push_back({1, -1, 1e3, 2.0, Complex(1.0, 1.0)});
  const std::vector<RigidMotion> motions = fit_hinged_motions(parts, ties, 2.0);
  EXPECT_LT(std::abs(motions[0].at(0.0)), 1e-6);
  EXPECT_LT(std::abs(motions[0].at(1.0) - motions[1].at(1.0)), 1e-6);
  EXPECT_LT(std::abs(motions[1].at(2.0) - Complex(1.0, 1.0)), 1e-6);
  EXPECT_NEAR(std::abs(motions[0].at(1.0)), 1.0, 1e-6);
}

}  // namespace
}  // namespace planar::testing
