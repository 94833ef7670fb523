// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "base/index.h"
#include "cage/cage_support.h"
#include "characters.h"
#include "mesh/orientation.h"
#include "mesh/triangle_shape.h"
#include "planar/distortion.h"
#include "planar/poser.h"
#include "posing/posing_method.h"
#include "posing/upright_patches.h"
#include "slivers.h"

/// Posing through a cage, as who poses the dense mesh sees it.
namespace planar::testing {
namespace {

constexpr std::array methods{PoserMethod::hold, PoserMethod::akvf, PoserMethod::arap};

double furthest(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

Points stored(const Points& x) { return x.cast<float>().cast<double>(); }

/// A dense square with pins in three corners.
struct Square {
  Shape shape = grid(61);
  std::vector<int> pins{0, 60, 61 * 61 - 1};
  Points start = shape.vertices(pins, Eigen::all);
  Points targets = start + (Points(3, 2) << 0.0, 0.0, 0.1, 0.3, -0.2, 0.2).finished();

  Poser poser(PoserMethod method, std::optional<int> cage = 300) const {
    Poser result(shape.vertices, shape.triangles, {.method = method, .cage = cage});
    result.set_handles(at(shape, pins));
    return result;
  }
};

TEST(CageMethod, AMeshNoLargerThanTheCageIsSolvedAsItIs) {
  const Square square;
  for (const PoserMethod method : methods) {
    Poser caged = square.poser(method, 61 * 61), plain = square.poser(method, {});
    caged.move(square.targets);
    plain.move(square.targets);
    EXPECT_EQ(caged.settle(), plain.settle());
  }
}

TEST(CageMethod, RigidTargetsGiveARigidMotion) {
  const Square square;
  for (const PoserMethod method : methods) {
    Poser poser = square.poser(method);
    const Points expected = rigid_motion(square.shape.vertices, 1.1, 5.0, -3.0);
    poser.move(rigid_motion(square.start, 1.1, 5.0, -3.0));
    EXPECT_LT(furthest(poser.settle(), expected), 1e-5);
    EXPECT_EQ(poser.report().flipped, 0);
    EXPECT_TRUE(poser.report().converged);
  }
}

/// What our own characters do in their poses, of the diagonal, while they are dragged, and in the end. Pins
/// of large poses have several minima beside each other, so that others cannot be compared in this way.
TEST(CageMethod, IsNearTheDenseSolutionAndEndsAtIt) {
  for (const char* name : {"fox", "dragon"}) {
    const auto character = characters::read(PLANAR_OWN_CHARACTERS, name);
    ASSERT_TRUE(character);
    const Shape shape = refined({character->vertices, character->triangles});
    const characters::Pose& pose = character->poses.front();
    std::array<Points, 2> dragged, posed;
    for (const bool caged : {false, true}) {
      Poser poser(shape.vertices, shape.triangles,
                  {.cage = caged ? std::optional<int>(2000) : std::optional<int>()});
      poser.set_handles(at(shape, pose.handles));
      dragged[caged] = poser.move(pose.targets);
      while (!poser.report().converged && !poser.report().coarse_settled) dragged[caged] = poser.refine();
      posed[caged] = poser.settle();
      EXPECT_TRUE(poser.report().converged);
      EXPECT_EQ(poser.report().flipped, 0);
      EXPECT_EQ(poser.report().flipped, distortion(shape.vertices, posed[caged], shape.triangles).flipped);
      EXPECT_LT(poser.report().furthest_handle, 1e-3 * character->diagonal());
    }
    EXPECT_LT(furthest(dragged[0], dragged[1]), 0.005 * character->diagonal()) << name;
    EXPECT_LT(furthest(posed[0], posed[1]), 5e-5 * character->diagonal()) << name;
  }
}

TEST(CageMethod, LegsThatTouchArePulledApart) {
  const Shape shape = slit_grid(61);
  Poser poser(shape.vertices, shape.triangles, {.cage = 200});
  const std::vector<int> pins{0, 60, 60 * 61, 61 * 61 - 1};
  poser.set_handles(at(shape, pins));
  Points targets = shape.vertices(pins, Eigen::all);
  targets.row(2) += Eigen::RowVector2d(-0.4, -0.1);
  targets.row(3) += Eigen::RowVector2d(0.4, -0.1);
  poser.move(targets);
  const Points& posed = poser.settle();
  EXPECT_EQ(poser.report().flipped, 0);
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int a = shape.triangles(t, c), b = shape.triangles(t, (c + 1) % 3);
      EXPECT_LT((posed.row(a) - posed.row(b)).norm(), 0.2) << "torn at " << a << " and " << b;
    }
  }
}

TEST(CageMethod, HandlesInTrianglesEndAtTheirTargets) {
  const Square square;
  for (const PoserMethod method : {PoserMethod::hold, PoserMethod::arap}) {
    Poser poser(square.shape.vertices, square.shape.triangles, {.method = method, .cage = 300});
    const Handles handles = inside(square.shape, {10, 3500, 7000});
    poser.set_handles(handles);
    Points targets = handles.positions(square.shape.vertices);
    targets.row(1) += Eigen::RowVector2d(0.1, 0.2);
    poser.move(targets);
    const Points reached = handles.positions(poser.settle());
    EXPECT_LT(furthest(reached, targets), 1e-3);
    EXPECT_NEAR(poser.report().furthest_handle, furthest(reached, targets), 1e-12);
  }
}

TEST(CageMethod, PartsWithoutHandlesAndLoneVerticesStayToTheBit) {
  Shape shape = joined(grid(41), moved(grid(41, 2), 0.3, 0.1));
  shape.vertices.conservativeResize(shape.vertices.rows() + 2, 2);
  shape.vertices.bottomRows(2) << 7.0, 7.0, 0.1, 0.1;
  Points start = shape.vertices + 0.003 * random_points(shape.vertices.rows(), 6);
  for (const PoserMethod method : methods) {
    Poser poser(shape.vertices, shape.triangles, {.method = method, .cage = 300});
    const auto lone = static_cast<int>(shape.vertices.rows()) - 1;
    const std::vector<int> pins{0, 40, lone};
    poser.set_handles(at(shape, pins));
    poser.reset(start);
    Points targets = start(pins, Eigen::all);
    targets.rowwise() += Eigen::RowVector2d(0.3, 0.3);
    poser.move(targets);
    const Points& posed = poser.settle();
    EXPECT_EQ(posed.bottomRows(41 * 41 + 2), start.bottomRows(41 * 41 + 2));
    EXPECT_NEAR(poser.report().furthest_handle, 0.3 * std::numbers::sqrt2, 1e-9);
    EXPECT_GT(furthest(posed.topRows(41 * 41), start.topRows(41 * 41)), 0.2);
  }
}

TEST(CageMethod, AStoredPoseIsGoneOnFrom) {
  const Square square;
  for (const PoserMethod method : {PoserMethod::hold, PoserMethod::akvf}) {
    Poser poser = square.poser(method), other = square.poser(method);
    const auto expect_back = [](Poser& again, const Points& targets, const Points& posed) {
      again.reset(posed);
      EXPECT_EQ(again.positions(), posed);
      EXPECT_LT(furthest(again.move(targets), posed), 1e-5);
      EXPECT_TRUE(again.report().converged || again.report().coarse_settled);
    };
    poser.move(square.targets);
    expect_back(poser, square.targets, stored(poser.settle()));
    // Another object does not know which triangles were put right; here none were.
    const Points nearer = square.start + 0.2 * (square.targets - square.start);
    poser.move(nearer);
    expect_back(other, nearer, stored(poser.settle()));
  }
}

/// Whoever takes hold of a settled drawing, and has not seen it settle.
TEST(CageMethod, NothingJumpsWhenASettledDrawingIsTakenHoldOf) {
  const auto character = characters::read(PLANAR_OWN_CHARACTERS, "dragon");
  ASSERT_TRUE(character);
  const Shape shape = refined({character->vertices, character->triangles});
  const characters::Pose& pose = character->poses.front();
  Poser first(shape.vertices, shape.triangles, {.cage = 1500});
  first.set_handles(at(shape, pose.handles));
  const Points coarse = first.move(pose.targets);
  const Points settled = stored(first.settle());
  ASSERT_GT(furthest(coarse, settled), 1e-3 * character->diagonal());

  std::vector<int> pins(pose.handles.begin(), pose.handles.end());
  pins.push_back(0);  // beside them a new one, which makes the cage anew
  Poser second(shape.vertices, shape.triangles, {.cage = 1500});
  second.set_handles(at(shape, pins));
  Points targets(pose.targets.rows() + 1, 2);
  targets << pose.targets, settled.row(0);
  for (Poser* poser : {&first, &second}) {
    poser->reset(settled);
    Points to = poser == &first ? pose.targets : targets;
    EXPECT_LT(furthest(poser->move(to), settled), 1e-4 * character->diagonal());
    Points before = poser->positions();
    for (int step = 1; step <= 5; ++step) {
      const double way = 1e-3 * character->diagonal();
      to.row(0) += Eigen::RowVector2d(way, 0.0);
      EXPECT_LT(furthest(poser->move(to), before), way + 1e-4 * character->diagonal());
      before = poser->positions();
    }
  }
}

TEST(CageMethod, ADragGoesOnFromASettledDrawingAsIfItHadNotSettled) {
  const auto character = characters::read(PLANAR_OWN_CHARACTERS, "fox");
  ASSERT_TRUE(character);
  const Shape shape = refined(refined({character->vertices, character->triangles}));
  const characters::Pose& pose = character->poses.front();
  const Points start = shape.vertices(pose.handles, Eigen::all);
  std::array<Poser, 2> posers{Poser(shape.vertices, shape.triangles, {.cage = 1500}),
                              Poser(shape.vertices, shape.triangles, {.cage = 1500})};
  for (Poser& poser : posers) poser.set_handles(at(shape, pose.handles));
  for (int step = 1; step <= 30; ++step) {
    for (Poser& poser : posers) poser.move(start + step / 30.0 * (pose.targets - start));
    if (step == 15) posers[1].settle();
    // A pin that is drawn out draws its neighbours with it: at once in one, a move later in the other.
    EXPECT_LT(furthest(posers[0].positions(), posers[1].positions()), 0.02 * character->diagonal()) << step;
  }
}

TEST(CageMethod, RefinementsGoOnToTheDrawingItselfStepByStep) {
  const Square square;
  Poser poser = square.poser(PoserMethod::hold), plain = square.poser(PoserMethod::hold, {});
  plain.move(square.targets);
  poser.move(square.targets);
  Points before = poser.positions();
  int coarse = 0, dense = 0;
  while (!poser.report().converged && coarse + dense < 100) {
    ++(poser.report().coarse_settled ? dense : coarse);
    const Points& now = poser.refine();
    EXPECT_LT(furthest(now, before), (refine_limit + 1e-6) * std::numbers::sqrt2);
    before = now;
  }
  EXPECT_TRUE(poser.report().converged);
  EXPECT_GT(coarse, 0);
  EXPECT_GT(dense, 0);
  EXPECT_LT(furthest(before, plain.settle()), 5e-5);
  // A further move is for the coarse mesh again.
  Points targets = square.targets;
  targets(1, 0) += 0.2;
  poser.move(targets);
  EXPECT_FALSE(poser.report().converged);
}

TEST(CageMethod, WhatTakesLongIsCancelledAndNothingIsLost) {
  const Square square;
  Poser poser = square.poser(PoserMethod::hold);
  const auto no = [](double) { return false; };
  Poser stopped = square.poser(PoserMethod::hold);
  const Points moved = stopped.move(square.targets);
  EXPECT_THROW(stopped.settle(no), Cancelled);
  EXPECT_TRUE(stopped.positions() == moved);
  EXPECT_LT(furthest(stopped.move(square.targets), moved), 0.1);

  poser.move(square.targets);
  while (!poser.report().coarse_settled) poser.refine(no);  // the coarse mesh is not asked for
  const Points coarse = poser.positions();
  EXPECT_THROW(poser.refine(no), Cancelled);
  EXPECT_TRUE(poser.positions() == coarse);
  Poser same = square.poser(PoserMethod::hold);
  same.move(square.targets);
  while (!same.report().coarse_settled) same.refine();
  for (int piece = 0; piece < 2; ++piece) {
    EXPECT_TRUE(poser.refine() == same.refine());  // what was cancelled leaves no trace
    EXPECT_THROW(poser.refine(no), Cancelled);
  }
  const Points refined = poser.positions();
  EXPECT_THROW(poser.settle([](double) -> bool { throw std::logic_error("asked"); }), std::logic_error);
  EXPECT_TRUE(poser.positions() == refined);

  double last = 0.0;
  const Points settled = poser.settle([&last](double share) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1.0);
    last = share;
    return true;
  });
  Poser other = square.poser(PoserMethod::hold, {});
  other.move(square.targets);
  EXPECT_LT(furthest(settled, other.settle()), 5e-5);

  std::vector<double> shares;
  const auto ask = [&shares](double share) {
    shares.push_back(share);
    return shares.size() < 3;
  };
  EXPECT_THROW(Poser(square.shape.vertices, square.shape.triangles, {.cage = 300, .progress = ask}),
               Cancelled);
  EXPECT_EQ(shares.size(), 3U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
}

/// A bump that no cage has: moved pins carry it, and none jumps.
TEST(CageMethod, WhatACageCannotHaveIsTurnedUntilHoldSettles) {
  const Square square;
  Points bumped = square.shape.vertices;
  const Eigen::RowVector2d middle = bumped.row(30 * 61 + 30);
  for (Eigen::Index v = 0; v < bumped.rows(); ++v)
    bumped(v, 1) += 0.008 * std::exp(-(bumped.row(v) - middle).squaredNorm() / 2e-4);
  const Points turned = rigid_motion(square.start, std::numbers::pi / 2.0, 0.0, 0.0);

  Poser akvf = square.poser(PoserMethod::akvf);
  akvf.reset(bumped);
  akvf.move(turned);
  EXPECT_LT(furthest(akvf.settle(), rigid_motion(bumped, std::numbers::pi / 2.0, 0.0, 0.0)), 1e-4);

  Poser hold = square.poser(PoserMethod::hold);
  hold.reset(bumped);
  for (int step = 0; step < 3; ++step) {
    const Points& shown = hold.move(square.start);
    EXPECT_LT(furthest(shown(square.pins, Eigen::all), square.start), 1e-4);
    EXPECT_LT(furthest(shown, bumped), 2e-3);
    EXPECT_FALSE(hold.report().converged);
  }
  EXPECT_LT(furthest(hold.settle(), square.shape.vertices), 1e-4);
  EXPECT_TRUE(hold.report().converged);
}

TEST(CageMethod, TheSameCallsGiveTheSameBits) {
  const Square square;
  for (const PoserMethod method : methods) {
    std::array<Points, 2> posed;
    for (Points& x : posed) {
      Poser poser = square.poser(method);
      poser.move(square.targets);
      poser.refine();
      poser.set_handles(at(square.shape, {0, 60, 1800}));
      poser.move(square.targets);
      x = poser.settle();
    }
    EXPECT_EQ(posed[0], posed[1]);
  }
}

TEST(CageMethod, PaintedStiffnessIsThatOfTheDenseTriangles) {
  const Square square;
  Eigen::VectorXd stiffness(square.shape.triangles.rows());
  for (Eigen::Index t = 0; t < stiffness.size(); ++t)
    stiffness[t] = square.shape.vertices(square.shape.triangles(t, 0), 1) > 0.5 ? 30.0 : 1.0;
  std::array<Points, 2> posed;
  for (const bool caged : {false, true}) {
    Poser poser(square.shape.vertices, square.shape.triangles,
                {.stiffness = stiffness, .cage = caged ? std::optional<int>(800) : std::optional<int>()});
    poser.set_handles(at(square.shape, square.pins));
    poser.move(square.targets);
    posed[caged] = poser.settle();
  }
  EXPECT_LT(furthest(posed[0], posed[1]), 0.008);  // 0.013 from that without the stiffness
}

TEST(CageMethod, HostileMeshesAreAtLeastFinite) {
  Shape pinched = joined(grid(30), moved(grid(30, 3), 1.3, 1.3));
  for (int& v : pinched.triangles.reshaped()) v = v == 900 ? 899 : v;
  for (const Shape& shape : {with_slivers(grid(40), 4), overlapping_strip(200, 10), pinched}) {
    for (const PoserMethod method : methods) {
      Poser poser(shape.vertices, shape.triangles, {.method = method, .cage = 100});
      const Drag drag = random_drag(shape, 8);
      poser.set_handles(at(shape, drag.pins));
      for (int step = 1; step <= 3; ++step)
        EXPECT_TRUE(poser.move(drag.start + step / 3.0 * (drag.targets - drag.start)).allFinite());
      EXPECT_TRUE(poser.settle().allFinite());
      EXPECT_TRUE(method == PoserMethod::arap || poser.report().flipped == 0) << poser.report().flipped;
    }
  }
}

TEST(CageMethod, RefusesWhatIsNoCageAndHandlesOfNoTriangle) {
  const Square square;
  EXPECT_REFUSAL(square.poser(PoserMethod::hold, 11), "cage: 11 vertices");
  EXPECT_REFUSAL(square.poser(PoserMethod::hold, -1), "cage");
  Poser poser = square.poser(PoserMethod::hold);
  Handles apart = at(square.shape, {0});
  apart.vertices.row(0) << 0, 60, 1;
  apart.weights.row(0) << 0.5, 0.5, 0.0;
  EXPECT_REFUSAL(poser.set_handles(apart), "handles, row 0: its vertices are not those of one triangle");
  apart.vertices.row(0) << 0, 5000, 1;
  EXPECT_REFUSAL(poser.set_handles(apart), "handles, row 0: vertex 5000");
  // The handles of before are still there.
  poser.move(square.targets);
  EXPECT_LT(poser.report().furthest_handle, 0.1);
}

TEST(UprightPatches, TurnTrianglesBackAndLeaveTheRest) {
  const Shape shape = grid(30);
  const Orientation orientation(shape.vertices, shape.triangles,
                                flat_triangles(shape.vertices, shape.triangles));
  Points x = rigid_motion(shape.vertices, 0.5, 1.0, 2.0);
  const Points before = x;
  x.row(10 * 30 + 10) += Eigen::RowVector2d(0.07, 0.02);
  x.row(20 * 30 + 5) += Eigen::RowVector2d(-0.08, 0.03);
  ASSERT_GT(orientation.count_flipped(x), 3);
  std::vector<char> fixed(planar::at(x.rows()));
  std::vector<int> all(planar::at(shape.triangles.rows()));
  std::iota(all.begin(), all.end(), 0);
  const std::vector<int> turned = turn_upright(shape.vertices, orientation, {0.0, 0.0}, {}, fixed, all, x);
  EXPECT_EQ(orientation.count_flipped(x), 0);
  EXPECT_LT(turned.size(), 120U);
  EXPECT_LT(furthest(x, before), 1e-3);
  EXPECT_EQ(x.topRows(30), before.topRows(30));

  // Round a fixed one, the others make way.
  x.row(10 * 30 + 10) += Eigen::RowVector2d(0.05, 0.02);
  const Eigen::RowVector2d place = x.row(10 * 30 + 10);
  fixed[10 * 30 + 10] = 1;
  turn_upright(shape.vertices, orientation, {0.0, 0.0}, {}, fixed, all, x);
  EXPECT_EQ(orientation.count_flipped(x), 0);
  EXPECT_EQ(x.row(10 * 30 + 10), place);
}

}  // namespace
}  // namespace planar::testing
