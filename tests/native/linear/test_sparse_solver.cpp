// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <thread>
#include <utility>

#include "dense.h"
#include "energy/killing_energy.h"
#include "linear/sparse_solver.h"
#include "planar/types.h"
#include "support.h"

namespace planar::testing {
namespace {

template <class Number>
SelfAdjointMatrix<Number> lower(const Eigen::MatrixX<Number>& dense) {
  SelfAdjointMatrix<Number> result;
  result.size = static_cast<int>(dense.rows());
  result.column_start.push_back(0);
  for (int j = 0; j < result.size; ++j) {
    for (int i = j; i < result.size; ++i) {
      if (dense(i, j) == 0.0) continue;
      result.row.push_back(i);
      result.value.push_back(dense(i, j));
    }
    result.column_start.push_back(static_cast<int>(result.row.size()));
  }
  return result;
}

Eigen::MatrixXd positive_matrix(int side) {
  const Shape shape = grid(side);
  return dense_k(shape.vertices, shape.triangles) +
         0.01 * Eigen::MatrixXd::Identity(2 * side * side, 2 * side * side);
}

/// The same couplings of vertices, each with a turn of its own.
Eigen::MatrixXcd hermitian_matrix(int side) {
  const int n = 2 * side * side;
  Eigen::MatrixXcd result = positive_matrix(side).cast<std::complex<double>>();
  for (int j = 0; j < n; ++j) {
    for (int i = j + 1; i < n; ++i) {
      result(i, j) *= std::polar(0.9, std::sin(3.0 * i + j));
      result(j, i) = std::conj(result(i, j));
    }
  }
  // Turns can make it indefinite: a dominant diagonal cannot be.
  for (int i = 0; i < n; ++i) result(i, i) = 0.01 + result.row(i).cwiseAbs().sum() - std::abs(result(i, i));
  return result;
}

class SparseSolverTest : public ::testing::TestWithParam<Backend> {};

TEST_P(SparseSolverTest, SolvesLikeADenseFactorization) {
  for (const int side : {2, 5, 14}) {
    const Eigen::MatrixXd dense = positive_matrix(side);
    const SymmetricMatrix matrix = lower(dense);
    const auto solver = SparseSolver::create(GetParam());
    solver->analyze(matrix);
    solver->factorize(matrix);
    const Eigen::VectorXd expected = flat(random_points(dense.rows() / 2, 3));
    Eigen::VectorXd x;
    solver->solve(dense * expected, x);
    // Condition number up to 1e4, a few units in the last place: 1e-11.
    EXPECT_LT((x - expected).lpNorm<Eigen::Infinity>(), 1e-11) << side;
    Eigen::VectorXd in_place = dense * expected;
    solver->solve(in_place, in_place);
    EXPECT_EQ(in_place, x);
  }
}

TEST_P(SparseSolverTest, FactorsNewValuesOfTheSamePattern) {
  const Eigen::MatrixXd dense = positive_matrix(6);
  const auto solver = SparseSolver::create(GetParam());
  solver->analyze(lower(dense));
  solver->factorize(lower(dense));
  solver->factorize(lower<double>(4.0 * dense));
  Eigen::VectorXd x;
  solver->solve(dense * Eigen::VectorXd::Ones(72), x);
  EXPECT_LT((x - Eigen::VectorXd::Constant(72, 0.25)).lpNorm<Eigen::Infinity>(), 1e-11);
}

TEST_P(SparseSolverTest, OrderIsAPermutationThatSavesFill) {
  const SymmetricMatrix pattern = lower(positive_matrix(12));
  const auto solver = SparseSolver::create(GetParam());
  std::vector<int> order = solver->fill_reducing_order(pattern);
  EXPECT_NE(order.front(), 0);
  std::sort(order.begin(), order.end());
  std::vector<int> all(order.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(order, all);
}

TEST_P(SparseSolverTest, IndefiniteMatricesFailAndLeaveTheSolverUsable) {
  const Eigen::MatrixXd dense = positive_matrix(6);
  Eigen::MatrixXd indefinite = dense;
  indefinite(40, 40) = -1.0;
  const auto solver = SparseSolver::create(GetParam());
  solver->analyze(lower(dense));
  EXPECT_THROW(solver->factorize(lower(indefinite)), SolveError);
  solver->factorize(lower(dense));
  Eigen::VectorXd x;
  solver->solve(dense * Eigen::VectorXd::Ones(72), x);
  EXPECT_LT((x - Eigen::VectorXd::Ones(72)).lpNorm<Eigen::Infinity>(), 1e-11);
}

TEST_P(SparseSolverTest, SeveralRightSidesAreSolvedLikeByADenseFactorization) {
  for (const int side : {2, 5, 14}) {
    const Eigen::MatrixXd dense = positive_matrix(side);
    const auto solver = SparseSolver::create(GetParam());
    solver->analyze(lower(dense));
    solver->factorize(lower(dense));
    const Eigen::LLT<Eigen::MatrixXd> expected(dense);
    for (const int columns : {0, 1, 2, 3, 4, 7, 8, 9, 16, 31}) {
      const RightSides right = RightSides::Random(dense.rows(), columns);
      RightSides x = right;
      solver->solve(x);
      if (columns == 0) continue;  // Eigen's own solve takes the address of the first
      // Condition number up to 1e4, a few units in the last place of numbers up to 1e2: 1e-10.
      EXPECT_TRUE((x - expected.solve(right)).isZero(1e-10)) << side << ' ' << columns;
    }
  }
}

TEST_P(SparseSolverTest, AColumnDependsOnNoOther) {
  const Eigen::MatrixXd dense = positive_matrix(9);
  const auto solver = SparseSolver::create(GetParam());
  solver->analyze(lower(dense));
  solver->factorize(lower(dense));
  const RightSides right = RightSides::Random(dense.rows(), 15);
  RightSides together = right;
  solver->solve(together);
  for (Eigen::Index j = 0; j < right.cols(); ++j) {
    RightSides alone = right.col(j);
    solver->solve(alone);
    EXPECT_EQ(alone, together.col(j)) << j;
  }
}

TEST_P(SparseSolverTest, ThreadsShareAFactor) {
  const Eigen::MatrixXd dense = positive_matrix(14);
  const auto solver = SparseSolver::create(GetParam());
  solver->analyze(lower(dense));
  solver->factorize(lower(dense));
  const RightSides right = RightSides::Random(dense.rows(), 8);
  RightSides alone = right;
  solver->solve(alone);
  std::vector<RightSides> x(4, right);
  std::vector<std::thread> threads;
  for (RightSides& own : x) {
    threads.emplace_back([&solver = std::as_const(*solver), &own, &right] {
      for (int i = 0; i < 20; ++i) {
        own = right;
        solver.solve(own);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const RightSides& own : x) EXPECT_EQ(own, alone);
}

TEST_P(SparseSolverTest, RefusesPivotsThatAreNoNumbers) {
  const Eigen::MatrixXd dense = positive_matrix(6);
  for (const int i : {0, 1, 40, 71}) {
    SymmetricMatrix matrix = lower(dense);
    const auto solver = SparseSolver::create(GetParam());
    solver->analyze(matrix);
    matrix.value[static_cast<std::size_t>(matrix.find(i, i))] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(solver->factorize(matrix), SolveError) << i;
  }
}

TEST_P(SparseSolverTest, SolversInTwoThreadsGiveTheBitsOfOne) {
  const Shape shape = grid(50);
  const Mesh mesh(2500, shape.triangles);
  std::vector<int> kept(2500);
  std::iota(kept.begin(), kept.end(), 0);
  KillingMatrix killing(mesh, kept);
  killing.assemble(shape.vertices, {}, {1});
  for (const int v : kept) killing.add(v, v, 0.01);
  const SymmetricMatrix& matrix = killing.matrix();
  const auto run = [&](Eigen::VectorXd& x) {
    const auto solver = SparseSolver::create(GetParam());
    solver->analyze(matrix);
    for (int i = 0; i < 5; ++i) {
      solver->factorize(matrix);
      solver->solve(Eigen::VectorXd::Ones(matrix.size), x);
    }
  };
  Eigen::VectorXd alone, first, second;
  run(alone);
  std::thread other([&] { run(first); });
  run(second);
  other.join();
  EXPECT_EQ(alone, first);
  EXPECT_EQ(alone, second);
}

TEST_P(SparseSolverTest, LargeSystemsAndRightSidesOfAFewNumbers) {
  // Blocks of all sizes, and a shape whose factor has gaps.
  const Shape shape = joined(grid(45), ring(300));
  const Mesh mesh(shape.vertices.rows(), shape.triangles);
  const auto solver = SparseSolver::create(GetParam());
  std::vector<int> kept(static_cast<std::size_t>(mesh.n_vertices));
  std::iota(kept.begin(), kept.end(), 0);
  KillingMatrix killing(mesh, solver->fill_reducing_order(vertex_graph(mesh, kept)));
  killing.assemble(shape.vertices, {}, {1, 1});
  for (const int v : kept) killing.add(v, v, 0.01);
  const SymmetricMatrix& matrix = killing.matrix();
  solver->analyze(matrix);
  solver->factorize(matrix);
  const Eigen::Map<const Eigen::SparseMatrix<double>> lower(
      matrix.size, matrix.size, static_cast<Eigen::Index>(matrix.row.size()), matrix.column_start.data(),
      matrix.row.data(), matrix.value.data());
  Eigen::VectorXd x;
  for (const int step : {1, 1000}) {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix.size);
    for (int i = 7; i < matrix.size; i += step) right[i] = std::cos(i);
    solver->solve(right, x);
    const Eigen::VectorXd left = lower.selfadjointView<Eigen::Lower>() * x - right;
    // Entries of the matrix up to 1e2, of x up to 1e2: some units in the last place.
    EXPECT_LT(left.lpNorm<Eigen::Infinity>(), 1e-11) << step;
  }
}

TEST_P(SparseSolverTest, HermitianSystemsAreSolvedLikeByADenseFactorization) {
  for (const int side : {1, 2, 5, 14}) {
    const Eigen::MatrixXcd dense = hermitian_matrix(side);
    const HermitianMatrix matrix = lower(dense);
    const auto solver = HermitianSolver::create(GetParam());
    solver->analyze(matrix);
    const Eigen::VectorXcd expected = Eigen::VectorXcd::Random(dense.rows());
    Eigen::VectorXcd right, x;
    for (const double scale : {3.0, 1.0}) {
      HermitianMatrix scaled = matrix;
      for (auto& value : scaled.value) value *= scale;
      solver->factorize(scaled);
      right = scale * (dense * expected);
      solver->solve(right, x);
      // Condition number up to 1e4, a few units in the last place: 1e-11.
      EXPECT_LT((x - expected).lpNorm<Eigen::Infinity>(), 1e-11) << side;
    }
    solver->solve(right, right);
    EXPECT_EQ(right, x);
    EXPECT_LT((matrix.times(expected) - dense * expected).lpNorm<Eigen::Infinity>(), 1e-12);
  }
}

TEST_P(SparseSolverTest, HermitianRightSidesOfOneNumber) {
  const Eigen::MatrixXcd dense = hermitian_matrix(6);
  const auto solver = HermitianSolver::create(GetParam());
  solver->analyze(lower(dense));
  solver->factorize(lower(dense));
  for (const int i : {0, 30, 71}) {
    Eigen::VectorXcd right = Eigen::VectorXcd::Zero(72), x;
    right[i] = {0.0, 2.0};
    solver->solve(right, x);
    EXPECT_LT((dense * x - right).lpNorm<Eigen::Infinity>(), 1e-12) << i;
  }
}

TEST_P(SparseSolverTest, HermitianMatricesThatAreIndefiniteOrNoNumbersFailAndLeaveTheSolverUsable) {
  const Eigen::MatrixXcd dense = hermitian_matrix(6);
  const auto solver = HermitianSolver::create(GetParam());
  solver->analyze(lower(dense));
  for (const int i : {0, 1, 40, 71}) {
    for (const double pivot : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
      HermitianMatrix bad = lower(dense);
      bad.value[static_cast<std::size_t>(bad.find(i, i))] = pivot;
      EXPECT_THROW(solver->factorize(bad), SolveError) << i << ' ' << pivot;
    }
  }
  solver->factorize(lower(dense));
  Eigen::VectorXcd x;
  solver->solve(dense * Eigen::VectorXcd::Ones(72), x);
  EXPECT_LT((x - Eigen::VectorXcd::Ones(72)).lpNorm<Eigen::Infinity>(), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Backends, SparseSolverTest, ::testing::ValuesIn(backends()), [](const auto& kind) {
  return kind.param == Backend::cholmod ? "Cholmod" : "Eigen";
});

TEST(SparseSolver, ProductsAreThoseOfTheWholeMatrix) {
  const Eigen::MatrixXd dense = positive_matrix(5);
  const Eigen::VectorXd x = flat(random_points(dense.rows() / 2, 3));
  EXPECT_LT((lower(dense).times(x) - dense * x).lpNorm<Eigen::Infinity>(), 1e-13);
}

TEST(SparseSolver, PatternsOfGraphsAreFoundInThem) {
  const SymmetricMatrix pattern = graph_pattern(4, {{{3, 1}}, {{0, 1}}, {{1, 3}}});
  EXPECT_EQ(pattern.column_start, (std::vector<int>{0, 2, 4, 5, 6}));
  EXPECT_EQ(pattern.row, (std::vector<int>{0, 1, 1, 3, 2, 3}));
  EXPECT_EQ(pattern.find(1, 0), 1);
  EXPECT_EQ(pattern.find(3, 1), 3);
  EXPECT_EQ(pattern.find(3, 3), 5);
}

TEST(SparseSolver, MakesTheBackendsOfTheBuildAndNoOther) {
  const std::vector<Backend> present = backends();
  for (const Backend backend : {Backend::cholmod, Backend::eigen}) {
    if (std::find(present.begin(), present.end(), backend) != present.end()) {
      EXPECT_NE(SparseSolver::create(backend), nullptr);
      EXPECT_NE(HermitianSolver::create(backend), nullptr);
    } else {
      EXPECT_THROW(SparseSolver::create(backend), std::invalid_argument);
      EXPECT_THROW(HermitianSolver::create(backend), std::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace planar::testing
