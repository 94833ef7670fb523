// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "dense.h"
#include "planar/akvf.h"
#include "posing/killing_solver.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr double rigid_tolerance = 1e-12;  // METHODS 1
constexpr double dense_tolerance = 1e-9;   // condition numbers of the dense systems are up to 1e5

double difference(const Points& a, const Points& b) { return (a - b).cwiseAbs().maxCoeff(); }

struct Case {
  bool hard, dirichlet;
};

class EveryKind : public ::testing::TestWithParam<Case> {
 protected:
  static KillingOptions options() { return {.hard = GetParam().hard, .dirichlet = GetParam().dirichlet}; }
  static Points field(const Shape& shape, const Handles& handles, const Points& velocities) {
    return killing_field(shape.vertices, shape.triangles, handles, velocities, options());
  }
};

TEST_P(EveryKind, ReproducesRigidFields) {
  const Shape shape = grid(20);
  for (const Handles& handles : {at(shape, {0, 399}), at(shape, {105, 210, 288}),
                                 inside(shape, {100, 400, 650}), at(shape, {21, 22})}) {
    const Points expected = rigid_field(shape.vertices, 1.7, 0.3, -0.8);
    EXPECT_LT(difference(field(shape, handles, handles.positions(expected)), expected), rigid_tolerance);
  }
}

TEST_P(EveryKind, ReproducesRigidFieldsFarFromTheOrigin) {
  const Shape shape = moved(grid(12), 1000.0, -500.0);
  const Handles handles = at(shape, {40, 100});
  const Points expected = rigid_field(shape.vertices, 1.0, 0.0, 0.0);  // velocities of about 1000
  EXPECT_LT(difference(field(shape, handles, handles.positions(expected)), expected), 1e3 * rigid_tolerance);
}

TEST_P(EveryKind, PartsWithoutHandlesStay) {
  const Shape shape = joined(grid(5), moved(grid(5), 3.0, 0.0));
  const Points u = field(shape, at(shape, {0, 24}), random_points(2, 1));
  EXPECT_EQ(u.bottomRows(25), Points::Zero(25, 2));
  EXPECT_GT(u.topRows(25).norm(), 0.1);
}

TEST_P(EveryKind, PartsWithOneHandleTranslate) {
  const Shape shape = joined(grid(5), moved(grid(5), 3.0, 0.0));
  Points velocities(3, 2);
  velocities << 1, 2, 0.5, 0.25, -1, 0;
  const Points u = field(shape, at(shape, {0, 37, 24}), velocities);
  for (int i = 25; i < 50; ++i) EXPECT_LT((u.row(i) - velocities.row(1)).norm(), rigid_tolerance);
}

TEST_P(EveryKind, HandlesAtOnePointCountAsOne) {
  const Shape shape = grid(7);
  Points three(3, 2), two(2, 2), one(1, 2);
  three << 1, 0, 0, 1, 0, 3;
  two << 1, 0, 0, 2;
  one << 0, 2;
  EXPECT_LT(difference(field(shape, at(shape, {3, 24, 24}), three), field(shape, at(shape, {3, 24}), two)),
            rigid_tolerance);
  EXPECT_LT(
      difference(field(shape, at(shape, {24, 24}), three.bottomRows(2)), field(shape, at(shape, {24}), one)),
      rigid_tolerance);
  // The same point, named in two ways: a vertex, and a corner of a triangle.
  Handles mixed = at(shape, {24, 0});
  mixed.vertices.row(1) << 25, 24, 31;
  mixed.weights.row(1) << 0, 1, 0;
  EXPECT_LT(difference(field(shape, mixed, three.bottomRows(2)), field(shape, at(shape, {24}), one)),
            rigid_tolerance);
}

TEST_P(EveryKind, HandlesThatFallTogetherOnlyTranslate) {
  // Two points of the mesh in one place say nothing about a turn.
  Shape shape = grid(6);
  shape.vertices.row(14) = shape.vertices.row(15);
  Points velocities(2, 2);
  velocities << 1, 0, 0, 1;
  const Points u = field(shape, at(shape, {14, 15}), velocities);
  for (int i = 0; i < 36; ++i) EXPECT_LT((u.row(i) - Eigen::RowVector2d(0.5, 0.5)).norm(), rigid_tolerance);
}

TEST_P(EveryKind, IsolatedVerticesStay) {
  Shape shape = grid(4);
  shape.vertices.conservativeResize(18, 2);
  shape.vertices.bottomRows(2) << 5, 5, 6, 6;
  const Points u = field(shape, at(shape, {0, 15, 17}), random_points(3, 2));
  EXPECT_EQ(u.bottomRows(2), Points::Zero(2, 2));
  const Points alone = field(shape, at(shape, {17}), random_points(1, 2));
  EXPECT_EQ(alone, Points::Zero(18, 2));
}

TEST_P(EveryKind, DegenerateTrianglesGiveFiniteFields) {
  for (const double height : {0.0, 1e-300, 1e-12, -1e-7}) {
    Shape shape = grid(6);
    for (int i = 0; i < 12; ++i)
      shape.vertices(i, 1) = height * (i % 3);  // two rows of flat, partly inverted triangles
    const Handles handles = at(shape, {7, 35, 20});
    EXPECT_TRUE(field(shape, handles, random_points(3, 4)).allFinite()) << height;
    const Points expected = rigid_field(shape.vertices, 0.5, 1.0, 2.0);
    EXPECT_LT(difference(field(shape, handles, handles.positions(expected)), expected), rigid_tolerance);
  }
  Shape line = grid(5);
  line.vertices.col(1).setZero();
  EXPECT_TRUE(field(line, at(line, {0, 12, 24}), random_points(3, 5)).allFinite());
  line.vertices.setZero();
  EXPECT_TRUE(field(line, at(line, {0, 12, 24}), random_points(3, 5)).allFinite());
}

TEST_P(EveryKind, PiecesThatMeetInAVertexDoNotSwingFreely) {
  Shape shape{Points(5, 2), Triangles(2, 3)};
  shape.vertices << 0, 0, 0, 1, 1, 0.5, 2, 0, 2, 1;
  shape.triangles << 0, 1, 2, 2, 3, 4;
  const Handles handles = at(shape, {0, 1});
  const Points expected = rigid_field(shape.vertices, 1.0, 0.0, 0.0);
  EXPECT_LT(difference(field(shape, handles, handles.positions(expected)), expected), rigid_tolerance);
  Points stretch(2, 2);
  stretch << 0, -1, 0, 1;
  EXPECT_LT(field(shape, handles, stretch).cwiseAbs().maxCoeff(), 10.0);
}

TEST_P(EveryKind, ClosedPartsAndEmptyHandles) {
  Shape shape{random_points(4, 9), Triangles(4, 3)};
  shape.triangles << 0, 1, 2, 0, 1, 3, 1, 2, 3, 0, 2, 3;
  EXPECT_TRUE(field(shape, at(shape, {0, 3}), random_points(2, 1)).allFinite());
  EXPECT_EQ(field(shape, at(shape, {}), Points(0, 2)), Points::Zero(4, 2));
}

TEST_P(EveryKind, DoesNotDependOnUnitOrPlace) {
  const Shape shape = grid(9);
  Shape other = moved(shape, 0.5, 4.0);
  other.vertices *= 250.0;
  const Handles handles = at(shape, {10, 40, 66});
  const Points velocities = random_points(3, 8);
  EXPECT_LT(difference(field(shape, handles, velocities), field(other, handles, velocities)),
            dense_tolerance);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryKind,
                         ::testing::Values(Case{false, false}, Case{false, true}, Case{true, false},
                                           Case{true, true}),
                         [](const auto& kind) {
                           return std::string(kind.param.hard ? "Hard" : "Soft") +
                                  (kind.param.dirichlet ? "Dirichlet" : "First");
                         });

class EveryBackend : public ::testing::TestWithParam<Backend> {
 protected:
  static Points field(const Shape& shape, const Handles& handles, const Points& velocities,
                      const KillingOptions& options) {
    KillingSolver solver(Mesh(shape.vertices.rows(), shape.triangles),
                         {.hard = options.hard, .dirichlet = options.dirichlet, .backend = GetParam()});
    solver.use(solver.compile(handles, Eigen::VectorXd::Constant(handles.size(), options.pin_weight)));
    Points result;
    solver.prepare(shape.vertices, options.stiffness);
    solver.solve(velocities, result);
    return result;
  }
};

TEST_P(EveryBackend, SoftFieldsSolve7) {
  const Shape shape = grid(12);
  for (const double weight : {0.1, 1.0, 1000.0}) {
    for (const Handles& handles : {at(shape, {0, 77, 143}), inside(shape, {10, 111, 200, 201})}) {
      const Points velocities = random_points(handles.size(), 6);
      const Points u = field(shape, handles, velocities, {.pin_weight = weight, .dirichlet = false});
      EXPECT_LT(difference(u, dense_soft(shape, handles, velocities, weight)), dense_tolerance) << weight;
    }
  }
}

TEST_P(EveryBackend, DirichletFieldsSolve8) {
  const Shape shape = grid(12);
  for (const bool hard : {false, true}) {
    for (const Handles& handles : {at(shape, {0, 77, 66}), inside(shape, {10, 111, 200})}) {
      const Points velocities = random_points(handles.size(), 6);
      const Points first = field(shape, handles, velocities, {.hard = hard, .dirichlet = false});
      const Points u = field(shape, handles, velocities, {.hard = hard});
      EXPECT_LT(difference(u, dense_dirichlet(shape, first)), dense_tolerance) << hard;
      EXPECT_GT(difference(u, first), 1e-3);
    }
  }
}

TEST_P(EveryBackend, StiffnessMultipliesTheRowsOfP) {
  const Shape shape = grid(8);
  const Eigen::VectorXd stiffness = random_points(98, 4).col(0).array().exp() * 3.0;
  const Handles handles = at(shape, {0, 27, 63});
  const Points velocities = random_points(3, 6);
  const Points first = dense_soft(shape, handles, velocities, 1.0, stiffness);
  const Points u = field(shape, handles, velocities, {.stiffness = stiffness});
  EXPECT_LT(difference(u, dense_dirichlet(shape, first, stiffness)), dense_tolerance);
}

TEST_P(EveryBackend, HardHandlesAreMetAndTheRestMinimisesTheEnergy) {
  const Shape shape = grid(9);
  for (const Handles& handles :
       {at(shape, {0, 40, 80}), inside(shape, {3, 64, 120}), at(shape, {30, 31, 39, 40})}) {
    const Points velocities = random_points(handles.size(), 5);
    const Points u = field(shape, handles, velocities, {.hard = true, .dirichlet = false});
    EXPECT_LT(difference(handles.positions(u), velocities), dense_tolerance);
    // K U lies in the span of Cᵀ: what is left after its projection is the gradient along the constraints.
    const Eigen::MatrixXd c = dense_c(handles, 81);
    const Eigen::VectorXd gradient = dense_k(shape.vertices, shape.triangles) * flat(u);
    const Eigen::VectorXd left = gradient - c.transpose() * solved(c * c.transpose(), c * gradient);
    EXPECT_LT(left.lpNorm<Eigen::Infinity>(), dense_tolerance);
  }
}

TEST_P(EveryBackend, DependentHardHandlesAreMetByLeastSquares) {
  // Four points of one triangle, of which three fix it.
  const Shape shape = grid(6);
  Handles handles = inside(shape, {20, 20, 20, 20});
  handles.weights << 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.25, 0.25, 0.5;
  const Points affine = rigid_field(shape.vertices, 0.4, 1.0, 0.0) + 0.3 * shape.vertices;
  const Points u = field(shape, handles, handles.positions(affine), {.hard = true, .dirichlet = false});
  EXPECT_LT(difference(handles.positions(u), handles.positions(affine)), 1e-8);
  EXPECT_TRUE(field(shape, handles, random_points(4, 3), {.hard = true}).allFinite());
}

// A mesh that is factored by the caller's thread, and one large enough for others.
TEST_P(EveryBackend, NewHandlesAndPositionsGiveWhatANewSolverGives) {
  for (const int side : {10, 35}) {
    const Shape shape = grid(side);
    const int n = side * side;
    KillingSolver solver(Mesh(n, shape.triangles), {.backend = GetParam()});
    Points kept;
    for (const Handles& handles :
         {at(shape, {0, n - 1}), inside(shape, {7, 80, n}), at(shape, {44}), at(shape, {side + 3, n - 1})}) {
      Shape bent = shape;
      bent.vertices += 0.01 * random_points(n, static_cast<unsigned>(handles.size()));
      const Points velocities = random_points(handles.size(), 2), others = random_points(handles.size(), 3);
      const Points expected = field(bent, handles, velocities, {});
      solver.prepare(bent.vertices, {});
      solver.use(solver.compile(handles, Eigen::VectorXd::Ones(handles.size())));
      EXPECT_FALSE(solver.is_prepared(bent.vertices));
      solver.prepare(shape.vertices, {});  // dropped
      solver.prepare(bent.vertices, {});
      EXPECT_TRUE(solver.is_prepared(bent.vertices));
      EXPECT_FALSE(solver.is_prepared(shape.vertices));
      solver.solve(velocities, kept);
      EXPECT_EQ(kept, expected);
      EXPECT_TRUE(solver.is_prepared(bent.vertices));
      solver.solve(others, kept);
      solver.solve(velocities, kept);
      EXPECT_EQ(kept, expected);
    }
  }
}

TEST_P(EveryBackend, FailuresOfTheThreadsSurfaceInSolveAndAreForgotten) {
  const Shape shape = grid(35);
  const Handles handles = at(shape, {0, 612, 1224});
  const Points velocities = random_points(3, 2);
  const Points expected = field(shape, handles, velocities, {});
  KillingSolver solver(Mesh(1225, shape.triangles), {.backend = GetParam()});
  solver.use(solver.compile(handles, Eigen::VectorXd::Ones(3)));
  Points u;
  for (const bool ask : {true, false}) {
    const Eigen::VectorXd broken = Eigen::VectorXd::Constant(shape.triangles.rows(), -1.0);
    solver.prepare(shape.vertices, broken);
    if (ask) {
      EXPECT_THROW(solver.solve(velocities, u), SolveError);
      EXPECT_FALSE(solver.is_prepared(shape.vertices));
    }
    solver.prepare(shape.vertices, {});
    solver.solve(velocities, u);
    EXPECT_EQ(u, expected);
  }
  solver.prepare(shape.vertices, {});  // ends under way
}

INSTANTIATE_TEST_SUITE_P(Backends, EveryBackend, ::testing::ValuesIn(backends()), [](const auto& kind) {
  return kind.param == Backend::cholmod ? "Cholmod" : "Eigen";
});

TEST(KillingField, MeshesThatAreAllBoundaryNeedOnly7) {
  const Shape shape = ring(20);
  const Handles handles = at(shape, {0, 7, 30});
  const Points velocities = random_points(3, 1);
  const Points first =
      killing_field(shape.vertices, shape.triangles, handles, velocities, {.dirichlet = false});
  EXPECT_EQ(killing_field(shape.vertices, shape.triangles, handles, velocities), first);
  EXPECT_LT(difference(first, dense_soft(shape, handles, velocities, 1.0)), dense_tolerance);
}

TEST(KillingField, HandlesOnTheBoundaryAloneNeedOnly7) {
  const Shape shape = grid(8);
  const Handles handles = at(shape, {0, 7, 60});
  const Points velocities = random_points(3, 1);
  const Points first =
      killing_field(shape.vertices, shape.triangles, handles, velocities, {.dirichlet = false});
  EXPECT_EQ(killing_field(shape.vertices, shape.triangles, handles, velocities), first);
  EXPECT_LT(difference(first, dense_dirichlet(shape, first)), dense_tolerance);
}

TEST(KillingField, PatchesKeepTheirPullThrough8) {
  const Shape shape = grid(9);
  const Handles handles = at(shape, {0, 8, 40, 41, 49});
  const Points velocities = random_points(5, 3);
  Points u;
  KillingSolver solver(Mesh(81, shape.triangles), {});
  solver.use(solver.compile(handles, Eigen::VectorXd::Ones(5), {0, 0, 1, 1, 1}));
  solver.prepare(shape.vertices, {});
  solver.solve(velocities, u);
  EXPECT_EQ(u, killing_field(shape.vertices, shape.triangles, handles, velocities, {.dirichlet = false}));
}

TEST(KillingField, TwoThreadsGiveTheSameBitsEveryTime) {
  const Shape shape = grid(40);  // large enough for the second thread
  const Handles handles = at(shape, {0, 820, 1300});
  const Points velocities = random_points(3, 1);
  const Points first = killing_field(shape.vertices, shape.triangles, handles, velocities);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(killing_field(shape.vertices, shape.triangles, handles, velocities), first);
}

TEST(KillingField, RefusalsNameTheArgument) {
  const Shape shape = grid(4);
  const Handles handles = at(shape, {0, 15});
  const Points velocities = Points::Zero(2, 2);
  const auto call = [&](KillingOptions options) {
    return killing_field(shape.vertices, shape.triangles, handles, velocities, options);
  };
  EXPECT_REFUSAL(killing_field({}, {}, {}, {}), "vertices is empty");
  EXPECT_REFUSAL(killing_field(shape.vertices, Triangles(0, 3), handles, velocities), "triangles is empty");
  EXPECT_REFUSAL(killing_field(shape.vertices, shape.triangles, handles, Points::Zero(3, 2)),
                 "velocities has 3 rows");
  EXPECT_REFUSAL(killing_field(shape.vertices, shape.triangles, handles, Points::Constant(2, 2, NAN)),
                 "velocities, row 0");
  EXPECT_REFUSAL(call({.pin_weight = 0.0}), "pin_weight, row 0");
  EXPECT_REFUSAL(call({.pin_weight = NAN}), "pin_weight, row 0");
  EXPECT_REFUSAL(call({.stiffness = Eigen::VectorXd::Ones(17)}), "stiffness has 17 rows, expected 18");
  EXPECT_REFUSAL(call({.stiffness = Eigen::VectorXd::Constant(18, -1.0)}), "stiffness, row 0");
  Points broken = shape.vertices;
  broken(7, 0) = INFINITY;
  EXPECT_REFUSAL(killing_field(broken, shape.triangles, handles, velocities), "vertices, row 7");
  Handles wrong = handles;
  wrong.vertices(1, 0) = 16;
  EXPECT_REFUSAL(killing_field(shape.vertices, shape.triangles, wrong, velocities),
                 "handles, row 1: vertex 16");
  wrong.vertices.row(1) << 0, 1, 15;
  wrong.weights.row(1) << 0.5, 0.25, 0.25;
  EXPECT_REFUSAL(killing_field(shape.vertices, shape.triangles, wrong, velocities),
                 "handles, row 1: its vertices are not");
  wrong.weights.row(1) << 0.5, 0.5, 0.5;
  EXPECT_REFUSAL(killing_field(shape.vertices, shape.triangles, wrong, velocities),
                 "handles, row 1: the weights");
}

}  // namespace
}  // namespace planar::testing
