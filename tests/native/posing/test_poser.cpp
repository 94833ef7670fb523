// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <optional>
#include <thread>

#include "planar/akvf.h"
#include "planar/distortion.h"
#include "planar/log_spiral.h"
#include "planar/poser.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double rounding = 1e-12;

const PoserOptions akvf{.method = PoserMethod::akvf};

double difference(const Points& a, const Points& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// A bar of 25×6 vertices, 4 long and 1 wide.
Shape bar() {
  Shape shape{Points(150, 2), Triangles(240, 3)};
  for (int i = 0; i < 150; ++i) shape.vertices.row(i) << (i % 25) / 6.0, (i / 25) / 5.0;
  int row = 0;
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 24; ++i) {
      const int a = 25 * j + i;
      shape.triangles.row(row++) << a, a + 1, a + 25;
      shape.triangles.row(row++) << a + 1, a + 26, a + 25;
    }
  }
  return shape;
}

class Bar : public ::testing::Test {
 protected:
  Bar()
      : shape(bar()),
        handles(at(shape, {50, 62, 74})),
        rest(handles.positions(shape.vertices)),
        poser(shape.vertices, shape.triangles, akvf) {
    poser.set_handles(handles);
  }
  Shape shape;
  Handles handles;
  Points rest;
  Poser poser;
};

TEST_F(Bar, StartsAtRest) {
  EXPECT_EQ(poser.positions(), shape.vertices);
  EXPECT_EQ(poser.report().substeps, 0);
  EXPECT_TRUE(poser.report().converged);
}

TEST_F(Bar, HandlesAtTheirTargetsChangeNothing) {
  EXPECT_EQ(poser.move(rest), shape.vertices);
  EXPECT_EQ(poser.report().substeps, 0);
  EXPECT_EQ(poser.report().furthest_handle, 0.0);
}

TEST_F(Bar, ASmallStepIsThePapersStep) {
  Points targets = rest;
  targets.row(2) += Eigen::RowVector2d(0.02, 0.05);
  const Points u = killing_field(shape.vertices, shape.triangles, handles, targets - rest,
                                 {.pin_weight = Poser::default_pin_weight});
  const Points expected = advance_along_spirals(shape.vertices, shape.triangles, u);
  EXPECT_LT(difference(poser.move(targets), expected), rounding);
  EXPECT_EQ(poser.report().substeps, 1);
  EXPECT_EQ(poser.report().iterations, 1);
  EXPECT_NEAR(poser.report().furthest_handle,
              (handles.positions(expected) - targets).rowwise().norm().maxCoeff(), rounding);
}

TEST_F(Bar, RigidTargetsGiveARigidMotionAtAnyAngle) {
  for (const double angle : {0.2, 1.5, 3.0}) {
    poser.reset();
    const Points expected = rigid_motion(shape.vertices, angle, 0.7, -0.3);
    poser.move(rigid_motion(rest, angle, 0.7, -0.3));
    poser.settle();
    EXPECT_LT(difference(poser.positions(), expected), 1e-6)
        << angle;  // settle stops at 1e-6 of the diagonal
    EXPECT_TRUE(poser.report().converged);
  }
}

TEST_F(Bar, StepsAreCutSoThatNoTriangleInverts) {
  // The right end goes round the left one by 150° in one call.
  Points targets = rest;
  targets.row(2) << 4.0 * std::cos(2.6), 4.0 * std::sin(2.6) + 0.4;
  poser.move(targets);
  EXPECT_GT(poser.report().substeps, 5);
  EXPECT_LE(poser.report().substeps, 32);
  EXPECT_EQ(poser.report().flipped, 0);
  EXPECT_EQ(distortion(shape.vertices, poser.positions(), shape.triangles).flipped, 0);
  const double before = poser.report().furthest_handle;
  poser.settle();
  EXPECT_LE(poser.report().furthest_handle, before);
  EXPECT_EQ(poser.report().flipped, 0);
}

TEST_F(Bar, ImpossibleTargetsAreReportedAsSuch) {
  Points targets = rest;
  targets.row(1) = targets.row(0) * 0.9 + targets.row(2) * 0.1;
  targets.row(1).swap(targets.row(0));  // two handles have to pass through each other
  targets.row(2) += Eigen::RowVector2d(20.0, 0.0);
  poser.move(targets);
  poser.settle();
  EXPECT_TRUE(poser.positions().allFinite());
  EXPECT_EQ(poser.report().flipped, 0);
  EXPECT_EQ(poser.report().converged, poser.report().furthest_handle <= 1e-3 * std::sqrt(17.0));
  EXPECT_NEAR(poser.report().furthest_handle,
              (handles.positions(poser.positions()) - targets).rowwise().norm().maxCoeff(), rounding);
}

TEST_F(Bar, RefiningMovesNoVertexFar) {
  EXPECT_EQ(poser.refine(), shape.vertices) << "without targets";
  Points targets = rest;
  targets.row(2) += Eigen::RowVector2d(-2.0, 2.0);
  poser.move(targets);
  for (int i = 0; i < 100 && !poser.report().converged; ++i) {
    const Points before = poser.positions();
    poser.refine();
    EXPECT_LE((poser.positions() - before).rowwise().norm().maxCoeff(), 0.02 * std::sqrt(17.0));
  }
  EXPECT_TRUE(poser.report().converged);
}

TEST_F(Bar, WildTargetsStayFinite) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    poser.reset();
    for (int i = 0; i < 5; ++i) {
      poser.move(5.0 * random_points(3, 10 * seed + static_cast<unsigned>(i)));
      ASSERT_TRUE(poser.positions().allFinite());
      ASSERT_EQ(poser.report().flipped, 0);
    }
  }
}

TEST_F(Bar, RefusedTargetsKeepTheState) {
  Points targets = rest;
  targets.row(2) += Eigen::RowVector2d(0.3, 0.5);
  const Points before = poser.move(targets);
  const Report report = poser.report();
  targets(1, 1) = NAN;
  EXPECT_REFUSAL(poser.move(targets), "targets, row 1");
  targets(1, 1) = INFINITY;
  EXPECT_REFUSAL(poser.move(targets), "targets, row 1");
  EXPECT_REFUSAL(poser.move(Points::Zero(2, 2)), "targets has 2 rows, expected 3");
  EXPECT_REFUSAL(poser.reset(Points::Zero(3, 2)), "positions has 3 rows");
  EXPECT_REFUSAL(poser.reset(Points::Constant(150, 2, NAN)), "positions, row 0");
  EXPECT_REFUSAL(poser.set_handles(handles, Eigen::VectorXd::Ones(2)), "weights has 2 rows");
  EXPECT_REFUSAL(poser.set_handles(handles, Eigen::VectorXd::Zero(3)), "weights, row 0");
  EXPECT_REFUSAL(poser.set_handles(handles, {}, Eigen::VectorXi::Zero(2)), "groups has 2 rows");
  Handles wrong = handles;
  wrong.vertices(1, 0) = 150;
  EXPECT_REFUSAL(poser.set_handles(wrong), "handles, row 1");
  EXPECT_EQ(poser.positions(), before);
  EXPECT_EQ(poser.report().furthest_handle, report.furthest_handle);
  // The handles are still those of before, and so are the targets.
  Poser other(shape.vertices, shape.triangles, akvf);
  other.set_handles(handles);
  targets = rest;
  targets.row(2) += Eigen::RowVector2d(0.3, 0.5);
  other.move(targets);
  EXPECT_EQ(poser.settle(), other.settle());
}

TEST_F(Bar, NumericalFailuresKeepTheState) {
  Points targets = rest;
  targets.row(2) += Eigen::RowVector2d(0.3, 0.5);
  const Points before = poser.move(targets);
  targets.setConstant(1e308);
  targets(0, 0) = -1e308;
  EXPECT_THROW(poser.move(targets), SolveError);
  EXPECT_EQ(poser.positions(), before);
}

TEST_F(Bar, ResetGoesBackOrContinuesFromGivenPositions) {
  Points targets = rest;
  targets.row(2) += Eigen::RowVector2d(-0.2, 0.6);
  const Points first = poser.move(targets);
  poser.reset();
  EXPECT_EQ(poser.positions(), shape.vertices);
  EXPECT_EQ(poser.settle(), shape.vertices) << "targets are forgotten";
  EXPECT_EQ(poser.move(targets), first) << "nothing else is remembered";
  poser.reset(first);
  EXPECT_EQ(poser.positions(), first);
  Points mirrored = shape.vertices;
  mirrored.col(0) *= -1.0;
  poser.reset(mirrored);
  EXPECT_EQ(poser.report().flipped, 240);
}

TEST_F(Bar, TheSameInputGivesTheSameBitsInAnyThread) {
  const auto run = [&](Points& result) {
    const Shape large = grid(40);
    Poser own(large.vertices, large.triangles, akvf);
    const Handles pins = at(large, {0, 820, 1599});
    own.set_handles(pins);
    Points targets = pins.positions(large.vertices);
    for (int i = 0; i < 8; ++i) {
      targets.row(1) += Eigen::RowVector2d(0.01, -0.02);
      own.move(targets);
    }
    result = own.settle();
  };
  Points alone, first, second;
  run(alone);
  std::thread other([&] { run(first); });
  run(second);
  other.join();
  EXPECT_EQ(alone, first);
  EXPECT_EQ(alone, second);
}

TEST_F(Bar, PatchesShareOnePinsWeight) {
  // A patch of four handles pulls against two others as strongly as a single handle of the same weight would
  // in its place.
  Handles five = at(shape, {0, 74, 73, 49, 99, 24});
  Poser grouped(shape.vertices, shape.triangles, {.method = PoserMethod::akvf, .pin_weight = 2.0}),
      weighted(shape.vertices, shape.triangles, {.method = PoserMethod::akvf, .pin_weight = 2.0});
  Eigen::VectorXi groups(6);
  groups << 5, 7, 7, 7, 7, -3;
  grouped.set_handles(five, {}, groups);
  Eigen::VectorXd weights(6);
  weights << 1, 1, 1, 1, 1, 1;
  weighted.set_handles(five, weights, groups);
  Points targets = five.positions(shape.vertices);
  targets.middleRows(1, 4).col(1).array() += 0.02;
  EXPECT_EQ(grouped.move(targets), weighted.move(targets));
  Poser heavy(shape.vertices, shape.triangles, {.method = PoserMethod::akvf, .pin_weight = 2.0});
  heavy.set_handles(five);
  EXPECT_GT(five.positions(heavy.move(targets))(1, 1), five.positions(grouped.positions())(1, 1));
}

TEST_F(Bar, APatchInsideIsTurnedWithTheMeshRoundIt) {
  const Shape square = grid(21);
  std::vector<int> pinned, label;
  for (int i = 0; i < 441; ++i) {
    const bool patch = std::abs(i % 21 - 10) < 3 && std::abs(i / 21 - 10) < 3;
    if (!patch && i >= 21) continue;
    pinned.push_back(i);
    label.push_back(patch ? 1 : 0);
  }
  const Handles pins = at(square, pinned);
  const Eigen::Map<Eigen::VectorXi> groups(label.data(), static_cast<Eigen::Index>(label.size()));
  Poser turning(square.vertices, square.triangles, akvf);
  turning.set_handles(pins, {}, groups);
  Points targets = pins.positions(square.vertices);
  targets.rowwise() -= Eigen::RowVector2d(0.5, 0.5);
  const Points turned = rigid_motion(targets, 1.5, 0.0, 0.0);
  for (Eigen::Index i = 0; i < targets.rows(); ++i) {
    if (label[static_cast<std::size_t>(i)]) targets.row(i) = turned.row(i);
  }
  targets.rowwise() += Eigen::RowVector2d(0.5, 0.5);
  turning.move(targets);
  turning.settle();
  EXPECT_TRUE(turning.report().converged) << turning.report().furthest_handle;
  EXPECT_EQ(turning.report().flipped, 0);
}

/// Two grids side by side, not connected.
Shape two_parts() { return joined(grid(5), moved(grid(5, 2), 1.5, 0.0)); }

TEST(Poser, HandlesMayComeInAnyOrder) {
  // One group spans both parts; which of them its first handle belongs to must not matter.
  const Shape shape = two_parts();
  const std::vector<int> vertices{0, 4, 12, 24, 25, 37, 49};
  const std::vector<int> labels{0, 5, 5, 3, 1, 5, 2};
  const std::vector<std::vector<int>> orders{
      {0, 1, 2, 3, 4, 5, 6}, {5, 3, 4, 0, 2, 6, 1}, {6, 5, 4, 3, 2, 1, 0}};
  const Points rest = at(shape, vertices).positions(shape.vertices);
  Points targets = rest + 0.1 * random_points(7, 3);
  // The first part turns as a whole, the second one does not.
  targets.topRows(4) = rigid_motion(rest.topRows(4), 1.2, 0.2, 0.1);
  for (const PoserMethod method : {PoserMethod::hold, PoserMethod::akvf}) {
    std::vector<Points> poses;
    for (const auto& order : orders) {
      std::vector<int> pinned;
      Eigen::VectorXi groups(7);
      Points wanted(7, 2);
      for (std::size_t i = 0; i < order.size(); ++i) {
        const auto from = static_cast<std::size_t>(order[i]);
        pinned.push_back(vertices[from]);
        groups[static_cast<Eigen::Index>(i)] = labels[from];
        wanted.row(static_cast<Eigen::Index>(i)) = targets.row(order[i]);
      }
      Poser poser(shape.vertices, shape.triangles, {.method = method});
      poser.set_handles(at(shape, pinned), {}, groups);
      poses.push_back(poser.move(wanted));
    }
    for (const Points& pose : poses) EXPECT_LT(difference(pose, poses[0]), 1e-9);
  }
}

TEST(Poser, CornersWithoutWeightCountForNothing) {
  // (a, b, c) with weights (0, w, 1 - w) is a point of the edge bc; a may be a vertex of another part.
  const Shape shape = two_parts();
  Handles handles = at(shape, {0, 4, 20, 25, 29, 45});
  Points targets = handles.positions(shape.vertices);
  targets.topRows(3) = rigid_motion(targets.topRows(3), 1.0, 0.1, 0.0);
  targets.bottomRows(3) = rigid_motion(targets.bottomRows(3), -0.8, 0.0, 2.0);
  for (const PoserMethod method : {PoserMethod::hold, PoserMethod::akvf}) {
    const auto pose = [&] {
      Poser poser(shape.vertices, shape.triangles, {.method = method});
      poser.set_handles(handles);
      return Points(poser.move(targets));
    };
    handles = at(shape, {0, 4, 20, 25, 29, 45});
    const Points expected = pose();
    for (const Eigen::Index i : {0, 2, 4}) {
      const int vertex = handles.vertices(i, 0);
      handles.vertices.row(i) << 49 - vertex, vertex, vertex;
      handles.weights.row(i) << 0.0, 1.0, 0.0;
    }
    EXPECT_EQ(pose(), expected);
  }
}

class Distance : public ::testing::TestWithParam<PoserMethod> {};

TEST_P(Distance, TargetsAreReachedAsFarAwayAsFloat32Allows) {
  const Shape shape = bar();
  const double size = std::sqrt(17.0);
  const Handles handles = at(shape, {50, 74});
  const auto pose = [&](double distance) {
    const Eigen::RowVector2d far = distance * size * Eigen::RowVector2d(0.6, -0.8);
    Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
    poser.set_handles(handles);
    Points targets = handles.positions(shape.vertices);
    targets.row(1) += Eigen::RowVector2d(0.2, 0.7);
    poser.move(targets.rowwise() + far);
    const Points x = poser.settle();
    EXPECT_TRUE(poser.report().converged) << distance;
    EXPECT_LT(poser.report().furthest_handle, 1e-3 * size) << distance;
    EXPECT_EQ(poser.report().flipped, 0) << distance;
    return Points(x.rowwise() - far);
  };
  const Points expected = pose(0.0);
  // The way there is another one for akvf, whose shapes depend on it.
  for (const double distance : {2.0, 10.0, 1e2, 1e3, 1e4, 1e5}) {
    EXPECT_LT(difference(pose(distance), expected), 0.02 * size) << distance;
  }
}

class GuardedDistance : public Distance {};

TEST_P(GuardedDistance, TargetsThatFloat32CannotReachAreApproached) {
  const Shape shape = bar();
  Poser poser(shape.vertices, shape.triangles, {.method = GetParam()});
  const Handles handles = at(shape, {50, 74});
  poser.set_handles(handles);
  const double far = 1e9;
  poser.move(handles.positions(shape.vertices).array() + far);
  EXPECT_FALSE(poser.report().converged);
  EXPECT_LT(poser.report().furthest_handle, std::sqrt(2.0) * far);
  EXPECT_EQ(distortion(shape.vertices, poser.positions(), shape.triangles).flipped, 0);
  // Nor does it stay there.
  poser.move(handles.positions(shape.vertices));
  poser.settle();
  EXPECT_TRUE(poser.report().converged);
}

TEST_P(Distance, ARestFarFromTheOriginIsPosedAsOneNearIt) {
  // Coordinates that lose no digits by the way there, so that only the result's are rounded.
  Shape shape = bar();
  shape.vertices = (shape.vertices * 1024.0).array().round() / 1024.0;
  const Handles handles = at(shape, {50, 62, 74});
  const auto pose = [&](double place) {
    const Eigen::RowVector2d offset(place, -place);
    const Points rest = shape.vertices.rowwise() + offset;
    Poser poser(rest, shape.triangles, {.method = GetParam()});
    poser.set_handles(handles);
    EXPECT_EQ(poser.positions(), rest);
    Points targets = handles.positions(shape.vertices).rowwise() + offset;
    for (int i = 0; i < 5; ++i) {
      targets.row(2) += Eigen::RowVector2d(0.0625, 0.125);
      poser.move(targets);
    }
    return Points(poser.positions().rowwise() - offset);
  };
  const double place = std::ldexp(1.0, 24);
  EXPECT_LE(difference(pose(place), pose(0.0)), 0.5 * 2.3e-16 * place);
}

TEST_P(Distance, OddSizesAndPlacesAreHarmless) {
  const Shape shape = grid(3);
  for (const auto& [size, place] : std::vector<std::pair<double, double>>{
           {1e-300, 0.0}, {1e-300, 1e-290}, {1e300, 0.0}, {1.5e308, 0.0}, {1.0, 1e17}, {1e-150, 1e150}}) {
    Points rest = (size * shape.vertices).array() + place;
    rest.col(0).setConstant(place);
    Poser poser(rest, shape.triangles, {.method = GetParam()});
    poser.set_handles(at(shape, {0, 8}));
    EXPECT_EQ(poser.positions(), rest);
    try {
      EXPECT_TRUE(poser.move(rest({0, 8}, Eigen::all).reverse()).allFinite()) << size;
    } catch (const SolveError&) {
      EXPECT_EQ(poser.positions(), rest);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, GuardedDistance, ::testing::Values(PoserMethod::hold, PoserMethod::akvf));
INSTANTIATE_TEST_SUITE_P(Methods, Distance,
                         ::testing::Values(PoserMethod::hold, PoserMethod::akvf, PoserMethod::arap));

TEST(Poser, StiffTrianglesBendLess) {
  const Shape shape = bar();
  Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(240);
  for (Eigen::Index t = 0; t < 240; ++t) {
    if (shape.vertices(shape.triangles(t, 0), 0) > 2.0) stiffness[t] = 100.0;
  }
  const Handles handles = at(shape, {50, 62, 74});
  Points targets = handles.positions(shape.vertices);
  targets.row(2) << 2.0 + 2.0 * std::cos(0.6),
      0.4 + 2.0 * std::sin(0.6);  // the stiff half can follow rigidly
  const auto bending = [&](const Eigen::VectorXd& factors) {
    Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::akvf, .stiffness = factors});
    poser.set_handles(handles);
    const Distortion d = distortion(shape.vertices, poser.move(targets), shape.triangles);
    double sum = 0.0;
    for (Eigen::Index t = 0; t < 240; ++t) sum += stiffness[t] > 1.0 ? d.triangle_angle[t] - 2.0 : 0.0;
    return sum;
  };
  EXPECT_LT(bending(stiffness), 0.2 * bending({}));
}

TEST(Poser, PartsIsolatedVerticesAndHoles) {
  Shape shape = joined(ring(16), moved(grid(5), 3.0, 0.0));
  shape = joined(shape, moved(grid(3), -3.0, 0.0));
  shape.vertices.conservativeResize(shape.vertices.rows() + 1, 2);
  shape.vertices.bottomRows(1) << 9, 9;
  const Handles handles = at(shape, {0, 8, 40, 66});  // two on the ring, one on the square, one isolated
  Poser poser(shape.vertices, shape.triangles, akvf);
  poser.set_handles(handles);
  Points targets = handles.positions(shape.vertices);
  targets.row(0) += Eigen::RowVector2d(0.2, 0.3);
  targets.row(2) += Eigen::RowVector2d(0.1, -0.4);
  targets.row(3) += Eigen::RowVector2d(1.0, 0.0);
  const Points& posed = poser.move(targets);
  EXPECT_GT(difference(posed.topRows(32), shape.vertices.topRows(32)), 0.1);
  const Points square = rigid_motion(shape.vertices.middleRows(32, 25), 0.0, 0.1, -0.4);
  EXPECT_LT(difference(posed.middleRows(32, 25), square), rounding);
  EXPECT_EQ(posed.bottomRows(10), shape.vertices.bottomRows(10));
  EXPECT_NEAR(poser.report().furthest_handle, 1.0, rounding) << "the isolated vertex cannot follow";
  EXPECT_FALSE(poser.report().converged);
}

TEST(Poser, DegenerateRestTrianglesAreCarriedAlong) {
  Shape shape = grid(8);
  for (int i = 0; i < 16; ++i) shape.vertices(i, 1) = 0.0;
  shape.vertices.row(27) = shape.vertices.row(28);
  const Handles handles = at(shape, {0, 36, 63});
  Poser poser(shape.vertices, shape.triangles, akvf);
  poser.set_handles(handles);
  Points targets = handles.positions(shape.vertices);
  for (int i = 0; i < 10; ++i) {
    targets.row(2) += Eigen::RowVector2d(-0.02, 0.03);
    poser.move(targets);
  }
  EXPECT_TRUE(poser.positions().allFinite());
  EXPECT_EQ(poser.report().flipped, 0);
  EXPECT_LT(poser.report().furthest_handle, 0.05);
}

TEST(Poser, WithoutHandlesNothingMoves) {
  const Shape shape = grid(4);
  Poser poser(shape.vertices, shape.triangles, akvf);
  EXPECT_EQ(poser.move(Points(0, 2)), shape.vertices);
  EXPECT_EQ(poser.settle(), shape.vertices);
  EXPECT_TRUE(poser.report().converged);
}

TEST(Poser, MovesAsAnObject) {
  const Shape shape = grid(4);
  Poser first(shape.vertices, shape.triangles, akvf);
  first.set_handles(at(shape, {5}));
  Poser second = std::move(first);
  const Points target = shape.vertices.row(5) + Eigen::RowVector2d(1.0, 1.0);
  EXPECT_LT(difference(second.move(target), rigid_motion(shape.vertices, 0.0, 1.0, 1.0)), rounding);
}

TEST(Poser, RefusesBadMeshesAndOptions) {
  const Shape shape = grid(3);
  EXPECT_REFUSAL(Poser({}, shape.triangles), "rest is empty");
  EXPECT_REFUSAL(Poser(shape.vertices, Triangles(0, 3)), "triangles is empty");
  EXPECT_REFUSAL(Poser(Points::Constant(9, 2, NAN), shape.triangles), "rest, row 0");
  EXPECT_REFUSAL(Poser(shape.vertices.topRows(8), shape.triangles), "triangles, row");
  EXPECT_REFUSAL(Poser(shape.vertices, shape.triangles, {.pin_weight = -1.0}), "pin_weight");
  EXPECT_REFUSAL(Poser(shape.vertices, shape.triangles, {.stiffness = Eigen::VectorXd::Ones(3)}),
                 "stiffness has 3 rows");
}

}  // namespace
}  // namespace planar::testing
