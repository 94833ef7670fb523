// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "dense.h"
#include "energy/cotangent_weights.h"
#include "planar/arap.h"
#include "planar/poser.h"
#include "support.h"

namespace planar::testing {
namespace {

Complex number(const Points& x, int v) { return {x(v, 0), x(v, 1)}; }

Points points(const Eigen::VectorXcd& v) {
  Points result(v.size(), 2);
  result << v.real(), v.imag();
  return result;
}

/// The two steps by dense least squares, from the printed formulas as corrected.
struct Dense {
  Dense(const Shape& rest, const Handles& handles, const Points& targets, double handle_weight,
        const Eigen::VectorXd& weight)
      : shape(rest), mesh(rest.vertices.rows(), rest.triangles), n_edges(weight.size()) {
    const Eigen::Index n = mesh.n_vertices, k = handles.size();
    first = second = Eigen::MatrixXcd::Zero(n_edges + k, n);
    right = Eigen::VectorXcd::Zero(n_edges + k);
    for (Eigen::Index e = 0; e < n_edges; ++e) {
      const auto [i, j] = mesh.edges[static_cast<std::size_t>(e)];
      const double row = std::sqrt(weight[e]);
      second(e, i) = first(e, i) = -row;
      second(e, j) = first(e, j) = row;
      first.row(e) -= row * edge(e) * similarity(e);
    }
    for (Eigen::Index h = 0; h < k; ++h) {
      for (int c = 0; c < 3; ++c) {
        const double entry = std::sqrt(handle_weight) * handles.weights(h, c);
        first(n_edges + h, handles.vertices(h, c)) += entry;
        second(n_edges + h, handles.vertices(h, c)) += entry;
      }
      right[n_edges + h] = std::sqrt(handle_weight) * number(targets, static_cast<int>(h));
    }
    similar = least_squares(first, right);
    for (Eigen::Index e = 0; e < n_edges; ++e) {
      const Complex turn = (similarity(e) * similar)(0);
      right[e] = std::sqrt(weight[e]) * edge(e) * turn / std::abs(turn);
    }
    final = least_squares(second, right);
  }

  Complex edge(Eigen::Index e) const {
    const auto [i, j] = mesh.edges[static_cast<std::size_t>(e)];
    return number(shape.vertices, j) - number(shape.vertices, i);
  }

  /// The row that takes v' to T of edge e, by the pseudo-inverse of G.
  Eigen::RowVectorXcd similarity(Eigen::Index e) const {
    const auto [i, j] = mesh.edges[static_cast<std::size_t>(e)];
    std::vector<int> corner{i, j};
    for (Eigen::Index t = 0; t < mesh.triangles.rows() && corner.size() < 4; ++t) {
      const Eigen::RowVector3i row = mesh.triangles.row(t);
      if (!(row.array() == i).any() || !(row.array() == j).any()) continue;
      corner.push_back(row.sum() - i - j);
    }
    const auto count = static_cast<Eigen::Index>(corner.size());
    Eigen::VectorXcd g(count);
    for (Eigen::Index m = 0; m < count; ++m)
      g[m] = number(shape.vertices, corner[static_cast<std::size_t>(m)]);
    g.array() -= g.mean();
    Eigen::RowVectorXcd result = Eigen::RowVectorXcd::Zero(mesh.n_vertices);
    for (Eigen::Index m = 0; m < count; ++m) {
      result[corner[static_cast<std::size_t>(m)]] += std::conj(g[m]) / g.squaredNorm();
    }
    return result;  // g has mean 0, so that the mean of v' does not matter
  }

  Shape shape;
  Mesh mesh;
  Eigen::Index n_edges;
  Eigen::MatrixXcd first, second;
  Eigen::VectorXcd right, similar, final;
};

Eigen::VectorXd weights(const Shape& shape, ArapWeights kind, const Eigen::VectorXd& stiffness = {}) {
  const Mesh mesh(shape.vertices.rows(), shape.triangles);
  if (kind == ArapWeights::uniform) return uniform_weights(mesh, stiffness);
  const auto rest = [&shape](int, int v) -> Eigen::Vector2d { return shape.vertices.row(v); };
  return cotangent_weights(mesh, rest, stiffness);
}

/// Two triangles on each side of an edge and a fin on it.
Shape fin() {
  Shape shape{Points(5, 2), Triangles(3, 3)};
  shape.vertices << 0, 0, 1, 0.1, 0.4, 0.9, 0.6, -0.8, 0.7, 0.5;
  shape.triangles << 0, 1, 2, 1, 0, 3, 0, 1, 4;
  return shape;
}

TEST(ArapTwoStep, EqualsADenseReading) {
  struct Case {
    Shape shape;
    Handles handles;
  };
  const Shape square = grid(6), rim = ring(9);
  for (const auto& [shape, handles] :
       {Case{square, at(square, {0, 5, 14, 35})}, Case{square, inside(square, {3, 20, 41})},
        Case{rim, at(rim, {0, 4, 13})}, Case{fin(), at(fin(), {2, 4})}}) {
    const Points targets = handles.positions(shape.vertices) + 0.5 * random_points(handles.size(), 3);
    for (const ArapWeights kind : {ArapWeights::cotangent, ArapWeights::uniform}) {
      for (const double weight : {1.0, 1000.0}) {
        const ArapSteps steps =
            arap_two_step(shape.vertices, shape.triangles, handles, targets, weight, kind);
        const Dense dense(shape, handles, targets, weight, weights(shape, kind));
        EXPECT_LT((steps.similar - points(dense.similar)).cwiseAbs().maxCoeff(), 1e-9);
        EXPECT_LT((steps.final - points(dense.final)).cwiseAbs().maxCoeff(), 1e-9);
      }
    }
  }
}

TEST(ArapTwoStep, MovesOfAPoserAreThatWithStiffnessAndWeights) {
  const Shape shape = grid(5);
  Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(shape.triangles.rows());
  stiffness.head(10).setConstant(20.0);
  const Handles handles = at(shape, {0, 4, 22});
  const Points targets = handles.positions(shape.vertices) + 0.4 * random_points(3, 8);
  Poser poser(shape.vertices, shape.triangles,
              {.method = PoserMethod::arap, .pin_weight = 10.0, .stiffness = stiffness});
  // The last two are one patch: each has half of its weight.
  poser.set_handles(handles, Eigen::Vector3d(10.0, 20.0, 20.0), Eigen::Vector3i(0, 1, 1));
  poser.move(targets);
  const Dense dense(shape, handles, targets, 100.0, weights(shape, ArapWeights::cotangent, stiffness));
  EXPECT_LT((poser.positions() - points(dense.final)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_TRUE(poser.report().converged);
  EXPECT_EQ(poser.report().iterations, 1);
}

TEST(ArapTwoStep, RigidMotionsAreExact) {
  const Shape shape = grid(9);
  const Handles handles = inside(shape, {0, 70, 127});
  for (const double angle : {0.0, 1.0, 3.1, -2.0}) {
    const Points expected = rigid_motion(shape.vertices, angle, 3.0, -2.0);
    for (const ArapWeights kind : {ArapWeights::cotangent, ArapWeights::uniform}) {
      const ArapSteps steps =
          arap_two_step(shape.vertices, shape.triangles, handles, handles.positions(expected), 1000.0, kind);
      EXPECT_LT((steps.similar - expected).cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_LT((steps.final - expected).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(ArapTwoStep, OnlyTheFirstStepScales) {
  const Shape shape = grid(8);
  const Handles handles = at(shape, {9, 54});
  const Points targets = 2.0 * handles.positions(shape.vertices);
  const ArapSteps steps = arap_two_step(shape.vertices, shape.triangles, handles, targets);
  EXPECT_LT((steps.similar - 2.0 * shape.vertices).cwiseAbs().maxCoeff(), 1e-10);
  // What no pin holds keeps its size.
  const double rest = (shape.vertices.row(1) - shape.vertices.row(0)).norm();
  EXPECT_NEAR((steps.final.row(1) - steps.final.row(0)).norm(), rest, 0.2 * rest);
}

TEST(ArapTwoStep, PartsWithoutHandlesStayAndThoseWithOneAreMoved) {
  const Shape part = grid(4);
  const Shape shape = joined(joined(part, moved(part, 3.0, 0.0)), moved(part, 0.0, 3.0));
  const Handles handles = at(shape, {0, 15, 16 + 5});
  Points targets = rigid_motion(handles.positions(shape.vertices), 0.7, 0.0, 0.0);
  const ArapSteps steps = arap_two_step(shape.vertices, shape.triangles, handles, targets);
  EXPECT_LT((steps.final - rigid_motion(shape.vertices, 0.7, 0.0, 0.0)).topRows(16).cwiseAbs().maxCoeff(),
            1e-11);
  const Eigen::RowVector2d way = targets.row(2) - shape.vertices.row(21);
  EXPECT_LT(((steps.final - shape.vertices).middleRows(16, 16).rowwise() - way).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_EQ(steps.final.bottomRows(16), shape.vertices.bottomRows(16));
  EXPECT_EQ(steps.similar.bottomRows(16), shape.vertices.bottomRows(16));
}

TEST(ArapTwoStep, EdgesKeepTheirDirectionWhereAllTargetsAreOne) {
  const Shape shape = grid(4);
  const Handles handles = at(shape, {0, 3, 12});
  Points targets(3, 2);
  targets.rowwise() = Eigen::RowVector2d(0.1, 77.3);
  const ArapSteps steps = arap_two_step(shape.vertices, shape.triangles, handles, targets);
  EXPECT_LT((steps.similar.rowwise() - targets.row(0)).cwiseAbs().maxCoeff(), 1e-12);
  // The pins pull the ends together; what is between two free vertices points as it did.
  const Eigen::RowVector2d rest = shape.vertices.row(10) - shape.vertices.row(5);
  const Eigen::RowVector2d now = steps.final.row(10) - steps.final.row(5);
  EXPECT_GT(now.dot(rest), 0.9 * now.norm() * rest.norm());
}

TEST(ArapTwoStep, PiecesThatMeetInAVertexAreBraced) {
  Shape hinge{Points(5, 2), Triangles(2, 3)};
  hinge.vertices << 0, 0, 1, 0, 0.5, 1, 0, 2, 1, 2;
  hinge.triangles << 0, 1, 2, 2, 3, 4;
  const Handles handles = at(hinge, {0, 1});
  const Points expected = rigid_motion(hinge.vertices, 1.0, 0.0, 0.0);
  const ArapSteps steps =
      arap_two_step(hinge.vertices, hinge.triangles, handles, handles.positions(expected));
  EXPECT_LT((steps.final - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ArapTwoStep, FlatTrianglesAreNoHindrance) {
  Shape shape = grid(5);
  shape.vertices.row(6) = shape.vertices.row(7);  // an edge without length
  shape.vertices.row(16) = 0.5 * (shape.vertices.row(15) + shape.vertices.row(17));
  for (int v : {18, 19, 23, 24}) shape.vertices.row(v) = shape.vertices.row(18);  // triangles without size
  const Handles handles = at(shape, {0, 4, 20});
  const Points targets = rigid_motion(handles.positions(shape.vertices), 2.0, 1.0, 0.0);
  const ArapSteps steps = arap_two_step(shape.vertices, shape.triangles, handles, targets);
  EXPECT_LT((steps.final - rigid_motion(shape.vertices, 2.0, 1.0, 0.0)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ArapTwoStep, RefusesWhatItCannotRead) {
  const Shape shape = grid(3);
  const Handles handles = at(shape, {0, 8});
  const Points targets = handles.positions(shape.vertices);
  const auto steps = [&](const Shape& s, const Handles& h, const Points& t, double w = 1000.0) {
    return arap_two_step(s.vertices, s.triangles, h, t, w);
  };
  EXPECT_REFUSAL(steps(shape, handles, targets.topRows(1)), "targets has 1 rows, expected 2");
  EXPECT_REFUSAL(steps(shape, handles, targets, 0.0), "handle_weight");
  EXPECT_REFUSAL(steps(shape, handles, targets / 0.0), "targets, row 0");
  Shape wrong = shape;
  wrong.triangles(1, 2) = 9;
  EXPECT_REFUSAL(steps(wrong, handles, targets), "triangles, row 1");
  wrong = shape;
  wrong.vertices(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_REFUSAL(steps(wrong, handles, targets), "rest, row 4");
  Handles astray = handles;
  astray.vertices(1, 0) = -1;
  EXPECT_REFUSAL(steps(shape, astray, targets), "handles, row 1");
}

TEST(ArapPoser, DependsOnHandlesAlone) {
  const Shape shape = grid(6);
  const Handles corners = at(shape, {0, 5, 30}), others = inside(shape, {1, 25, 44});
  const Points targets = others.positions(shape.vertices) + random_points(3, 5);
  Poser fresh(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  fresh.set_handles(others);
  fresh.move(targets);
  Poser used(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  used.set_handles(corners);
  used.move(random_points(3, 6));
  used.settle();
  used.set_handles(others);
  used.move(random_points(3, 7));
  used.reset(random_points(36, 8));
  EXPECT_EQ(used.move(targets), fresh.positions());
}

TEST(ArapPoser, RefineLeavesWhatAMoveGave) {
  const Shape shape = grid(5);
  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  poser.set_handles(at(shape, {0, 24, 12}));
  const Points posed = poser.move(2.0 * random_points(3, 4));
  EXPECT_GT(poser.report().furthest_handle, 0.0);
  EXPECT_EQ(poser.refine(), posed);
  EXPECT_TRUE(poser.report().converged);
  EXPECT_GT(poser.report().furthest_handle, 0.0);
}

/// Σ_t Σ_sides w/count |e' - R_t e|² + 1000 Σ |pin - target|² with the best R_t.
double rigid_energy(const Shape& shape, const Points& x, const Handles& handles, const Points& targets) {
  const Mesh mesh(shape.vertices.rows(), shape.triangles);
  const Eigen::VectorXd weight = weights(shape, ArapWeights::cotangent);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(weight.size());
  const auto side = [&](Eigen::Index t, int c) {
    return std::pair{shape.triangles(t, c), shape.triangles(t, (c + 1) % 3)};
  };
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) count[mesh.find_edge(side(t, c).first, side(t, c).second)] += 1.0;
  }
  double sum = 1000.0 * (handles.positions(x) - targets).squaredNorm();
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    Complex s = 0.0;
    for (int c = 0; c < 3; ++c) {
      const auto [a, b] = side(t, c);
      const int edge = mesh.find_edge(a, b);
      const Complex rest = number(shape.vertices, b) - number(shape.vertices, a);
      const Complex now = number(x, b) - number(x, a);
      const double w = weight[edge] / count[edge];
      sum += w * (std::norm(rest) + std::norm(now));
      s += w * std::conj(rest) * now;
    }
    sum -= 2.0 * std::abs(s);
  }
  return sum;
}

TEST(ArapPoser, SettlesAtAMinimumOfTheRigidEnergy) {
  const Shape shape = grid(6);
  const Handles handles = at(shape, {0, 5, 30, 35});
  Points targets = handles.positions(shape.vertices);
  targets.row(3) += Eigen::RowVector2d(0.5, -0.2);
  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  poser.set_handles(handles);
  const Points two_steps = poser.move(targets);
  const Points x = poser.settle();
  EXPECT_TRUE(poser.report().converged);
  EXPECT_GT(poser.report().iterations, 2);
  const double energy = rigid_energy(shape, x, handles, targets);
  EXPECT_LT(energy, rigid_energy(shape, two_steps, handles, targets));
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Points off = x + 1e-2 * random_points(36, seed);
    EXPECT_LT(energy, rigid_energy(shape, off, handles, targets));
  }
  EXPECT_EQ(poser.move(targets), two_steps);
}

TEST(ArapPoser, FailsWithoutAChange) {
  const Shape shape = grid(4);
  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  poser.set_handles(at(shape, {0, 15}));
  const Points targets = random_points(2, 1);
  const Points posed = poser.move(targets);
  Points far = targets;
  far(0, 0) = 1.7e308;
  far(1, 0) = -1.7e308;
  EXPECT_THROW(poser.move(far), SolveError);
  EXPECT_EQ(poser.positions(), posed);
  EXPECT_EQ(poser.settle().rows(), 16);
  Handles astray = at(shape, {0, 15});
  astray.vertices(0, 0) = 16;
  EXPECT_REFUSAL(poser.set_handles(astray), "handles, row 0");
  EXPECT_EQ(poser.move(targets), posed);
}

TEST(ArapPoser, TellsFlips) {
  const Shape shape = grid(6);
  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  const Handles handles = at(shape, {0, 5, 30, 35, 14});
  poser.set_handles(handles);
  Points targets = handles.positions(shape.vertices);
  poser.move(targets);
  EXPECT_EQ(poser.report().flipped, 0);
  targets.row(4) += Eigen::RowVector2d(2.0, 0.0);
  poser.move(targets);
  EXPECT_GT(poser.report().flipped, 0);
}

TEST(ArapPoser, WithoutHandlesNothingMoves) {
  const Shape shape = grid(3);
  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::arap});
  poser.set_handles(at(shape, {}));
  EXPECT_EQ(poser.move(Points(0, 2)), shape.vertices);
  EXPECT_EQ(poser.settle(), shape.vertices);
  EXPECT_TRUE(poser.report().converged);
}

}  // namespace
}  // namespace planar::testing
