// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "dense.h"
#include "inbetween/edge_equations.h"
#include "inbetween/inbetween_support.h"
#include "inbetween/paper_inbetween.h"
#include "planar/distortion.h"

/// The paper's Algorithms 1 and 2, against dense readings of its equations.
namespace planar::testing {
namespace {

using Frames = std::vector<std::vector<Complex>>;  // of a row: its entries

/// c(t_k)·Δt of (8), as corrected, by a forward (other = k+1) or a backward (k-1) difference.
double rate(const std::vector<Complex>& e, std::size_t k, std::size_t other) {
  const Complex velocity = other > k ? e[other] - e[k] : e[k] - e[other];
  const Complex normal = Complex(0.0, 1.0) * e[k];
  return (std::conj(normal) * velocity).real() / std::norm(e[k]);
}

/// Rows of (9) times Δt, forward and reverse, in the entries of e.
Eigen::MatrixXcd dense_rows(const std::vector<Complex>& e) {
  const auto last = static_cast<Eigen::Index>(e.size()) - 1;
  Eigen::MatrixXcd rows = Eigen::MatrixXcd::Zero(2 * last, last + 1);
  for (Eigen::Index k = 0; k < last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    rows(2 * k, k + 1) = 1.0;
    rows(2 * k, k) = -1.0 - Complex(0.0, rate(e, i, i + 1));
    rows(2 * k + 1, k + 1) = 1.0 - Complex(0.0, rate(e, i + 1, i));
    rows(2 * k + 1, k) = -1.0;
  }
  return rows;
}

std::vector<Complex> some_edge(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-0.3, 0.3);
  std::vector<Complex> e(size);
  for (std::size_t k = 0; k < size; ++k) {
    e[k] = std::polar(1.0 + value(random), 0.3 * static_cast<double>(k) + value(random));
  }
  return e;
}

TEST(PaperInbetween, EdgesMinimiseEquation9) {
  for (const std::size_t size : {3U, 4U, 10U, 40U}) {
    const std::vector<Complex> e = some_edge(size, 7);
    const Eigen::MatrixXcd rows = dense_rows(e);
    const auto last = static_cast<Eigen::Index>(size) - 1;
    const Eigen::MatrixXcd inner = rows.middleCols(1, last - 1);
    const Eigen::VectorXcd known = rows.col(0) * e.front() + rows.col(last) * e.back();
    const Eigen::VectorXcd expected = least_squares(inner, -known);
    Eigen::Array<Complex, 1, Eigen::Dynamic, Eigen::RowMajor> row(last + 1);
    std::copy(e.begin(), e.end(), row.data());
    minimise_edge_energy(row);
    EXPECT_LT((row.segment(1, last - 1).matrix().transpose() - expected).cwiseAbs().maxCoeff(), 1e-9);
  }
}

/// Algorithm 2 by dense algebra, `iterations` times around its loop.
std::vector<Points> dense_algorithm(const Points& from, const Points& to, const EdgeGraph& graph, int frames,
                                    int iterations, bool global) {
  const auto n_edges = graph.edges.size();
  const auto last = static_cast<std::size_t>(frames) - 1;
  const Eigen::VectorXd turns = breadth_first_turns(graph, from, to);
  Frames e(n_edges, std::vector<Complex>(last + 1));
  for (std::size_t i = 0; i < n_edges; ++i) {
    const Complex first = graph.vector(i, from), end = graph.vector(i, to);
    const double s = std::abs(end) / std::abs(first);
    for (std::size_t k = 0; k <= last; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(last);
      e[i][k] = (1.0 - t + t * s) * std::polar(1.0, t * turns[static_cast<Eigen::Index>(i)]) * first;  // (13)
    }
  }
  const Eigen::Index n = graph.n_vertices;
  Eigen::MatrixXcd points = Eigen::MatrixXcd::Zero(n, frames);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    if (global) {
      // (6) in all the inner frames' vertices, the first of each held at 0.
      const auto inner = static_cast<Eigen::Index>(last) - 1;
      Eigen::MatrixXcd rows =
          Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(2 * last * n_edges), inner * n);
      Eigen::VectorXcd known = Eigen::VectorXcd::Zero(rows.rows());
      for (std::size_t i = 0; i < n_edges; ++i) {
        const Eigen::MatrixXcd of_edge = dense_rows(e[i]);
        const Eigen::Index first_row = static_cast<Eigen::Index>(2 * last * i);
        for (Eigen::Index r = 0; r < of_edge.rows(); ++r) {
          for (Eigen::Index k = 0; k < of_edge.cols(); ++k) {
            if (k == 0 || k == inner + 1) {
              known[first_row + r] += of_edge(r, k) * e[i][static_cast<std::size_t>(k)];
              continue;
            }
            rows(first_row + r, (k - 1) * n + graph.edges[i][1]) += of_edge(r, k);
            rows(first_row + r, (k - 1) * n + graph.edges[i][0]) -= of_edge(r, k);
          }
        }
      }
      for (Eigen::Index k = 0; k < inner; ++k) rows.col(k * n).setZero();
      const Eigen::VectorXcd x = least_squares(rows, -known);
      points.middleCols(1, inner) = Eigen::Map<const Eigen::MatrixXcd>(x.data(), n, inner);
    } else {
      for (std::size_t k = 1; k < last; ++k) {
        Eigen::MatrixXcd rows = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(n_edges), n);
        Eigen::VectorXcd right(static_cast<Eigen::Index>(n_edges));
        for (std::size_t i = 0; i < n_edges; ++i) {  // (10)
          const double w = std::sqrt(1.0 / std::abs(e[i][k]));
          const auto row = static_cast<Eigen::Index>(i);
          rows(row, graph.edges[i][0]) = -w;
          rows(row, graph.edges[i][1]) = w;
          right[row] = w * e[i][k];
        }
        points.col(static_cast<Eigen::Index>(k)) = least_squares(rows, right);
      }
    }
    for (std::size_t i = 0; i < n_edges; ++i) {
      for (std::size_t k = 1; k < last; ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        e[i][k] = points(graph.edges[i][1], column) - points(graph.edges[i][0], column);
      }
      if (global || iteration + 1 == iterations) continue;
      const Eigen::MatrixXcd rows = dense_rows(e[i]);  // (9)
      const auto columns = static_cast<Eigen::Index>(last);
      const Eigen::MatrixXcd inner = rows.middleCols(1, columns - 1);
      const Eigen::VectorXcd known = rows.col(0) * e[i].front() + rows.col(columns) * e[i].back();
      const Eigen::VectorXcd x = least_squares(inner, -known);
      for (std::size_t k = 1; k < last; ++k) e[i][k] = x[static_cast<Eigen::Index>(k) - 1];
    }
  }
  // The centroid goes straight.
  std::vector<Points> result;
  for (std::size_t k = 0; k <= last; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(last);
    Points frame(n, 2);
    frame.col(0) = points.col(static_cast<Eigen::Index>(k)).real();
    frame.col(1) = points.col(static_cast<Eigen::Index>(k)).imag();
    const Eigen::RowVector2d centre = (1.0 - t) * from.colwise().mean() + t * to.colwise().mean();
    frame.rowwise() += centre - frame.colwise().mean();
    result.push_back(k == 0 ? from : k == last ? to : frame);
  }
  return result;
}

class Algorithm : public ::testing::TestWithParam<InbetweenMethod> {};

TEST_P(Algorithm, IsThePapersReadByDenseAlgebra) {
  const Shape shape = grid(4);
  const Points end = 1.1 * rigid_motion(grid(4, 8).vertices, 1.0, 2.0, 0.5);
  const EdgeGraph graph(16, shape.triangles);
  InbetweenOptions options;
  options.method = GetParam();
  options.tolerance = 1e-300;
  for (const int iterations : {2, 4}) {
    options.max_iterations = iterations - 1;
    const auto frames = inbetween({shape.vertices, end}, uniform(6), shape.triangles, options);
    const auto dense =
        dense_algorithm(shape.vertices, end, graph, 6, iterations, GetParam() == InbetweenMethod::global);
    EXPECT_LT(largest_difference(frames, dense), 1e-9);
  }
}

TEST_P(Algorithm, BendsABarWithoutShrinkingItInSmallSteps) {
  const Shape shape = bar(20);
  const Points end = rolled(shape.vertices, 120.0 * degrees);
  InbetweenOptions options;
  options.method = GetParam();
  const Distortion last = distortion(shape.vertices, end, shape.triangles);
  for (const Points& frame : inbetween({shape.vertices, end}, uniform(25), shape.triangles, options)) {
    const Distortion d = distortion(shape.vertices, frame, shape.triangles);
    EXPECT_EQ(d.flipped, 0);
    EXPECT_LE(d.area, 1.002 * last.area);
  }
}

TEST_P(Algorithm, ReversedKeysGiveReversedFrames) {
  const Shape shape = bar(12);
  const Points end = rolled(shape.vertices, 100.0 * degrees);
  InbetweenOptions options;
  options.method = GetParam();
  auto forward = inbetween({shape.vertices, end}, uniform(9), shape.triangles, options);
  std::reverse(forward.begin(), forward.end());
  EXPECT_LT(
      largest_difference(forward, inbetween({end, shape.vertices}, uniform(9), shape.triangles, options)),
      1e-9);
}

TEST_P(Algorithm, PartsAndIsolatedVerticesAreEachTheirOwn) {
  Shape shape = joined(bar(6), moved(grid(3), 2.0, 0.0));
  shape.vertices.conservativeResize(shape.vertices.rows() + 1, 2);
  shape.vertices.bottomRows(1) << 5.0, 5.0;
  Points end = shape.vertices;
  end.topRows(21) = rolled(shape.vertices.topRows(21), 1.5);
  end.middleRows(21, 9) = rigid_motion(shape.vertices.middleRows(21, 9), 2.0, 0.3, 0.4);
  InbetweenOptions options;
  options.method = GetParam();
  options.tolerance = 1e-12;
  const auto frames = inbetween({shape.vertices, end}, uniform(9), shape.triangles, options);
  const auto bar_alone =
      inbetween({shape.vertices.topRows(21), end.topRows(21)}, uniform(9), bar(6).triangles, options);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    // Parts have no equation in common; iterations end when the last of them has converged.
    EXPECT_LT(largest_difference(frames[k].topRows(21), bar_alone[k]), 1e-9) << k;
    EXPECT_LT((frames[k].bottomRows(1) - shape.vertices.bottomRows(1)).norm(), 1e-12) << k;
  }
}

/// From the first moment on, and with a share that grows.
TEST_P(Algorithm, TellsProgressAndCanBeCancelled) {
  const Shape shape = bar(60);
  const Points end = rolled(shape.vertices, 120.0 * degrees);
  InbetweenOptions options;
  options.method = GetParam();
  std::vector<double> shares;
  options.progress = [&shares](double share) {
    shares.push_back(share);
    return true;
  };
  const auto frames = inbetween({shape.vertices, end}, uniform(40), shape.triangles, options);
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_LE(shares.back(), 1.0);
  // Several times in an iteration; an iteration takes the share from i/(i+4) to (i+1)/(i+5).
  EXPECT_GT(std::count_if(shares.begin(), shares.end(), [](double share) { return share < 0.2; }), 2);
  for (const std::size_t last : {0U, 2U}) {
    std::size_t calls = 0;
    options.progress = [&calls, last](double) { return calls++ < last; };
    EXPECT_THROW(inbetween({shape.vertices, end}, uniform(40), shape.triangles, options), Cancelled);
    EXPECT_EQ(calls, last + 1);
  }
}

/// Calls far apart would keep a cancel waiting on large meshes.
TEST(GlobalMethod, TellsProgressWithinEachPassOverTheFrames) {
  const Shape shape = grid(24);
  InbetweenOptions options;
  options.method = InbetweenMethod::global;
  options.threads = 1;  // a batch of tasks is at least one for each thread
  options.max_iterations = 1;
  int calls = 0;
  options.progress = [&calls](double) { return ++calls > 0; };
  inbetween({shape.vertices, rolled(shape.vertices, 1.0)}, uniform(100), shape.triangles, options);
  EXPECT_GT(calls, 400);  // 796, and 60 with two calls in a step
}

TEST_P(Algorithm, NoBitDependsOnTheThreads) {
  const Shape shape = grid(9);
  const Points end = rolled(shape.vertices, 1.2);
  InbetweenOptions options;
  options.method = GetParam();
  options.threads = 1;
  const auto alone = inbetween({shape.vertices, end}, uniform(40), shape.triangles, options);
  options.threads = 5;
  EXPECT_EQ(inbetween({shape.vertices, end}, uniform(40), shape.triangles, options), alone);
}

TEST_P(Algorithm, RefusesMoreThanItSamples) {
  const Shape shape = grid(3);
  const Points& x = shape.vertices;
  InbetweenOptions options;
  options.method = GetParam();
  EXPECT_REFUSAL(inbetween({x, x, x}, uniform(3, 2.0), shape.triangles, options),
                 "keys: the paper's methods");
  EXPECT_REFUSAL(inbetween({x, x}, Eigen::Vector3d(0.0, 0.4, 1.0), shape.triangles, options), "times, row 1");
  EXPECT_REFUSAL(inbetween({x, x}, Eigen::VectorXd::Zero(1), shape.triangles, options), "times: ");
  EXPECT_REFUSAL(Inbetweens({x, x}, shape.triangles, options), "method");
  EXPECT_EQ(inbetween({x, x}, uniform(2), shape.triangles, options).size(), 2U);
  options.smooth = true;
  EXPECT_REFUSAL(inbetween({x, x}, uniform(3), shape.triangles, options), "smooth");
}

INSTANTIATE_TEST_SUITE_P(OfThePaper, Algorithm,
                         ::testing::Values(InbetweenMethod::paper, InbetweenMethod::global),
                         [](const auto& kind) {
                           return kind.param == InbetweenMethod::paper ? "Local" : "Global";
                         });

}  // namespace
}  // namespace planar::testing
