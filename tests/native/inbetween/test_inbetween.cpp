// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "dense.h"
#include "inbetween/inbetween_support.h"
#include "inbetween/midpoint_transition.h"
#include "planar/distortion.h"

/// The default method: closed forms, and what an animator relies on.
namespace planar::testing {
namespace {

/// Σ |e[k+1] - e[k] - iτ_k (e[k] + e[k+1])|² minimised over the inner entries by dense algebra.
std::vector<Complex> dense_midpoint(const std::vector<Complex>& e) {
  const auto n = static_cast<Eigen::Index>(e.size());
  Eigen::MatrixXcd rows = Eigen::MatrixXcd::Zero(n - 1, n);
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    const Complex first = e[static_cast<std::size_t>(k)], second = e[static_cast<std::size_t>(k) + 1];
    const Complex sum = first + second;
    const double tau = (std::conj(sum) * (second - first)).imag() / std::norm(sum);
    rows(k, k) = Complex(-1.0, -tau);
    rows(k, k + 1) = Complex(1.0, -tau);
  }
  const Eigen::VectorXcd known = rows.col(0) * e.front() + rows.col(n - 1) * e.back();
  const Eigen::MatrixXcd inner = rows.middleCols(1, n - 2);
  const Eigen::VectorXcd x = least_squares(inner, -known);
  std::vector<Complex> result{e.front()};
  result.insert(result.end(), x.data(), x.data() + x.size());
  result.push_back(e.back());
  return result;
}

TEST(MidpointEnergy, IsMinimisedLikeByDenseAlgebra) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (const std::size_t size : {3U, 4U, 9U, 30U}) {
    std::vector<Complex> e(size);
    for (std::size_t k = 0; k < size; ++k) {
      e[k] = std::polar(1.0 + 0.5 * value(random), 0.4 * static_cast<double>(k) + 0.3 * value(random));
    }
    const std::vector<Complex> expected = dense_midpoint(e);
    Eigen::Array<Complex, 1, Eigen::Dynamic, Eigen::RowMajor> row(static_cast<Eigen::Index>(size));
    std::copy(e.begin(), e.end(), row.data());
    minimise_midpoint_energy(row);
    for (std::size_t k = 0; k < size; ++k) {
      EXPECT_LT(std::abs(row[static_cast<Eigen::Index>(k)] - expected[k]), 1e-9) << size << ' ' << k;
    }
  }
}

/// A rotation by `angle` about a point far from the shape is given back exactly: by arcs as that rotation, by
/// straight anchors as the turn about a centroid that goes straight.
TEST(Inbetween, RigidMotionsAreExact) {
  const Shape shape = grid(6);
  for (const double angle : {0.0, 30.0 * degrees, -100.0 * degrees, 179.0 * degrees}) {
    const std::vector<Points> keys{shape.vertices, rigid_motion(shape.vertices, angle, 3.0, -1.0)};
    InbetweenOptions options;
    for (const double t : {0.25, 0.4, 0.9}) {
      const Points straight = inbetween(keys, Eigen::VectorXd::Constant(1, t), shape.triangles, options)[0];
      const Eigen::RowVector2d start = keys[0].colwise().mean(), end = keys[1].colwise().mean();
      Points expected = rigid_motion(shape.vertices.rowwise() - start, angle * t, 0.0, 0.0);
      expected.rowwise() += start + t * (end - start);
      EXPECT_LT(largest_difference(straight, expected), 1e-9) << angle;
      if (angle == 0.0) continue;
      options.anchor_path = AnchorPath::arc;
      const Points arc = inbetween(keys, Eigen::VectorXd::Constant(1, t), shape.triangles, options)[0];
      // The centre c of the rotation is its fixed point.
      const Complex c = Complex(3.0, -1.0) / (1.0 - std::polar(1.0, angle));
      const Complex shift = c - std::polar(1.0, angle * t) * c;
      EXPECT_LT(largest_difference(arc, rigid_motion(shape.vertices, angle * t, shift.real(), shift.imag())),
                1e-9)
          << angle;
      options.anchor_path = AnchorPath::straight;
    }
  }
}

TEST(Inbetween, ExtraTurnsSpinAPart) {
  const Shape two = joined(grid(4), moved(grid(4), 5.0, 0.0));
  Points end = two.vertices;
  end.rowwise() += Eigen::RowVector2d(0.0, 2.0);
  InbetweenOptions options;
  options.turns = (Eigen::MatrixXi(1, 2) << 0, -2).finished();
  const Points quarter =
      inbetween({two.vertices, end}, Eigen::VectorXd::Constant(1, 0.125), two.triangles, options)[0];
  const Points second = two.vertices.bottomRows(16);
  const Eigen::RowVector2d centre = second.colwise().mean();
  Points expected = two.vertices;
  expected.bottomRows(16) = rigid_motion(second.rowwise() - centre, -std::numbers::pi / 2.0, 0.0, 0.0);
  expected.bottomRows(16).rowwise() += centre;
  expected.rowwise() += Eigen::RowVector2d(0.0, 0.25);
  EXPECT_LT(largest_difference(quarter, expected), 1e-9);
}

/// Parts and isolated vertices that only translate keep their shape to the last digits.
TEST(Inbetween, PartsThatTranslateKeepTheirShape) {
  Shape shape = joined(grid(4), moved(grid(3, 2), 5.0, 0.0));
  shape.vertices.conservativeResize(shape.vertices.rows() + 1, 2);
  shape.vertices.bottomRows(1) << 9.0, 9.0;
  Points end = shape.vertices;
  end.topRows(16).rowwise() += Eigen::RowVector2d(1.0, 2.0);
  end.middleRows(16, 9).rowwise() += Eigen::RowVector2d(-3.0, 0.5);
  end.bottomRows(1) << 10.0, 8.0;
  for (const Points& frame : inbetween({shape.vertices, end}, uniform(5), shape.triangles)) {
    const Points way = (frame - shape.vertices).eval();
    const double t = way(0, 0);
    EXPECT_LT(largest_difference(frame, shape.vertices + t * (end - shape.vertices)), 1e-12);
  }
}

TEST(Inbetween, KeysComeBackToTheBit) {
  const Shape shape = grid(5);
  const std::vector<Points> keys{shape.vertices, 1.3 * rigid_motion(shape.vertices, 1.0, 2.0, 0.1),
                                 grid(5, 9).vertices};
  InbetweenOptions options;
  options.key_times = Eigen::Vector3d(-1.0, 0.1, 7.0);
  const auto frames = inbetween(keys, options.key_times, shape.triangles, options);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(frames[k], keys[k]);
  // And what is between them leads up to them.
  const auto near = inbetween(keys, Eigen::Vector2d(0.1 - 1e-9, 0.1 + 1e-9), shape.triangles, options);
  EXPECT_LT(largest_difference(near[0], keys[1]), 1e-6);
  EXPECT_LT(largest_difference(near[1], keys[1]), 1e-6);
}

TEST(Inbetween, IdenticalKeysStandStill) {
  const Shape shape = grid(5);
  for (const Points& frame : inbetween({shape.vertices, shape.vertices}, uniform(4), shape.triangles)) {
    EXPECT_LT(largest_difference(frame, shape.vertices), 1e-12);
  }
}

class Rolled : public ::testing::TestWithParam<int> {};

/// The printed form ends in NaN on the bar rolled by 400° in 4 frames.
TEST_P(Rolled, BarsAreDistortedNoMoreThanTheirKeys) {
  const Shape shape = bar(60);
  const Points end = rolled(shape.vertices, GetParam() * degrees);
  const Distortion last = distortion(shape.vertices, end, shape.triangles);
  for (const int frames : {4, 24}) {
    for (const Points& frame : inbetween({shape.vertices, end}, uniform(frames), shape.triangles)) {
      const Distortion d = distortion(shape.vertices, frame, shape.triangles);
      EXPECT_EQ(d.flipped, 0);
      EXPECT_LE(d.area, 1.001 * last.area);
      EXPECT_LE(d.angle, 1.001 * last.angle);
    }
  }
  // Half way it is rolled by half the angle: a circular arc, whose ends are as far apart as that says.
  const Points middle =
      inbetween({shape.vertices, end}, Eigen::VectorXd::Constant(1, 0.5), shape.triangles)[0];
  const Points arc = rolled(shape.vertices, GetParam() * degrees / 2.0);
  EXPECT_NEAR((middle.row(181) - middle.row(1)).norm(), (arc.row(181) - arc.row(1)).norm(), 2e-3);
}

INSTANTIATE_TEST_SUITE_P(By, Rolled, ::testing::Values(90, 180, 270, 400, 540, 720));

std::vector<Points> motion_of(const std::vector<Points>& keys, const Shape& shape,
                              const Eigen::VectorXd& times, int threads = 0) {
  InbetweenOptions options;
  options.threads = threads;
  return inbetween(keys, times, shape.triangles, options);
}

TEST(Inbetween, ReversedKeysGiveReversedFrames) {
  const Shape shape = bar(40);
  const std::vector<Points> keys{shape.vertices, rolled(shape.vertices, 200.0 * degrees),
                                 rolled(shape.vertices, -100.0 * degrees)};
  auto forward = motion_of(keys, shape, uniform(13, 2.0));
  const auto back = motion_of({keys[2], keys[1], keys[0]}, shape, uniform(13, 2.0));
  std::reverse(forward.begin(), forward.end());
  EXPECT_LT(largest_difference(forward, back), 1e-9);
}

TEST(Inbetween, AnySubsetOfTimesGivesTheSameFrames) {
  const Shape shape = bar(40);
  const std::vector<Points> keys{shape.vertices, rolled(shape.vertices, 200.0 * degrees)};
  const auto all = motion_of(keys, shape, uniform(25));
  const auto some = motion_of(keys, shape, Eigen::Vector3d(22.0 / 24.0, 1.0 / 24.0, 6.0 / 24.0));
  // To the bit: frames that are solved in one pass do not touch each other.
  const Inbetweens solved(keys, shape.triangles);
  EXPECT_LT(largest_difference(some[0], all[22]), 1e-12);
  EXPECT_EQ(some[1], solved.at(1.0 / 24.0));
  EXPECT_EQ(some[2], solved.at(6.0 / 24.0));
}

TEST(Inbetween, ThreadsDoNotChangeABit) {
  const Shape shape = grid(40);  // several blocks of edges
  const std::vector<Points> keys{shape.vertices, grid(40, 3).vertices};
  const auto one = motion_of(keys, shape, uniform(11), 1);
  for (const int threads : {2, 3}) {
    const auto several = motion_of(keys, shape, uniform(11), threads);
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i], several[i]);
  }
}

TEST(Inbetween, OneMoreKeyTakenFromTheMotionHardlyChangesIt) {
  const Shape shape = bar(60);
  const std::vector<Points> keys{shape.vertices, rolled(shape.vertices, 300.0 * degrees)};
  const auto frames = motion_of(keys, shape, uniform(25));
  InbetweenOptions options;
  options.key_times = Eigen::Vector3d(0.0, 10.0, 24.0);
  const auto again = inbetween({keys[0], frames[10], keys[1]}, uniform(25, 24.0), shape.triangles, options);
  double path = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) path += largest_difference(frames[i], frames[i - 1]);
  EXPECT_LT(largest_difference(frames, again), 0.02 * path);
}

TEST(Inbetween, MovesWithoutJumpsOrKinks) {
  const Shape shape = bar(60);
  const auto frames =
      motion_of({shape.vertices, rolled(shape.vertices, 300.0 * degrees)}, shape, uniform(201));
  for (std::size_t i = 2; i < frames.size(); ++i) {
    const Points before = frames[i - 1] - frames[i - 2], after = frames[i] - frames[i - 1];
    // A turn of 1.5° between two of these frames changes a velocity by 2.6 %.
    EXPECT_LT(largest_difference(before, after), 0.06 * before.rowwise().norm().maxCoeff()) << i;
  }
}

TEST(Inbetween, ContoursAndLinesKeepTheLengthOfTheirSides) {
  const int n = 40;
  Points line(n, 2);
  for (int i = 0; i < n; ++i) line.row(i) << static_cast<double>(i) / (n - 1), 0.0;
  const Points spiral = rolled(line, 500.0 * degrees);
  for (const Points& frame : inbetween({line, spiral}, uniform(9), contour(n, true))) {
    for (int i = 1; i < n; ++i) {
      const double from = (line.row(i) - line.row(i - 1)).norm(),
                   to = (spiral.row(i) - spiral.row(i - 1)).norm();
      const double length = (frame.row(i) - frame.row(i - 1)).norm();
      EXPECT_GT(length, 0.999 * std::min(from, to));
      EXPECT_LT(length, 1.001 * std::max(from, to));
    }
  }
  // A circle that becomes a flat ellipse of the same sides, roughly: no side shrinks much on the way.
  Points circle(n, 2), ellipse(n, 2);
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * i / n;
    circle.row(i) << std::cos(a), std::sin(a);
    ellipse.row(i) << -0.6 * std::sin(a), 1.3 * std::cos(a);
  }
  const Edges sides = contour(n);
  for (const Points& frame : inbetween({circle, ellipse}, uniform(9), sides)) {
    for (int i = 0; i < n; ++i) {
      const int j = (i + 1) % n;
      const double from = (circle.row(i) - circle.row(j)).norm(),
                   to = (ellipse.row(i) - ellipse.row(j)).norm();
      EXPECT_GT((frame.row(i) - frame.row(j)).norm(), 0.95 * std::min(from, to));
    }
  }
}

TEST(Inbetween, NothingDependsOnUnitOrOrigin) {
  const Shape shape = bar(30);
  const Points end = rolled(shape.vertices, 200.0 * degrees);
  const auto frames = motion_of({shape.vertices, end}, shape, uniform(7));
  const auto moved_far = [](const Points& x) {
    return ((1e-3 * x).rowwise() + Eigen::RowVector2d(5.0, -2.0)).eval();
  };
  const auto other = motion_of({moved_far(shape.vertices), moved_far(end)}, shape, uniform(7));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_LT(largest_difference(moved_far(frames[i]), other[i]), 1e-12);
  }
}

TEST(Inbetween, DegenerateKeysDoNotFail) {
  const Shape shape = grid(5);
  Points point = Points::Zero(25, 2), line = shape.vertices;
  line.col(1).setZero();
  for (const Points& end : {point, line}) {
    for (const Points& frame : motion_of({shape.vertices, end}, shape, uniform(5))) {
      EXPECT_TRUE(frame.allFinite());
    }
  }
  for (const Points& frame : motion_of({point, point}, shape, uniform(5))) EXPECT_EQ(frame, point);
}

TEST(Inbetween, AnchorsKeepToTheirPath) {
  const Shape shape = grid(5);
  const Points end = 1.2 * rigid_motion(shape.vertices, 1.2, 4.0, 1.0);
  InbetweenOptions options;
  options.anchors = {Eigen::Vector2i(3, 7)};
  const Points half =
      inbetween({shape.vertices, end}, Eigen::VectorXd::Constant(1, 0.5), shape.triangles, options)[0];
  const Eigen::RowVector2d start_at = (shape.vertices.row(3) + shape.vertices.row(7)) / 2.0,
                           end_at = (end.row(3) + end.row(7)) / 2.0;
  EXPECT_LT(((half.row(3) + half.row(7)) / 2.0 - (start_at + end_at) / 2.0).norm(), 1e-12);
}

TEST(Inbetween, ProgressRisesAndCanCancel) {
  const Shape shape = bar(30);
  const std::vector<Points> keys{shape.vertices, rolled(shape.vertices, 2.0), shape.vertices};
  std::vector<double> shares;
  InbetweenOptions options;
  options.progress = [&shares](double share) {
    shares.push_back(share);
    return true;
  };
  (void)inbetween(keys, uniform(5, 2.0), shape.triangles, options);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.size(), 3U);
  EXPECT_LE(shares.back(), 1.0);
  // Also while the frames are made, which takes longest where they are repaired.
  shares.clear();
  (void)inbetween(keys, uniform(200, 2.0), shape.triangles, options);
  EXPECT_GT(std::count_if(shares.begin(), shares.end(), [](double share) { return share > 0.5; }), 8);
  options.progress = [](double share) { return share < 0.9; };
  EXPECT_THROW((void)inbetween(keys, uniform(200, 2.0), shape.triangles, options), Cancelled);
  options.progress = [](double share) { return share < 0.4; };
  EXPECT_THROW((void)inbetween(keys, uniform(5, 2.0), shape.triangles, options), Cancelled);
}

TEST(Inbetween, RefusesWhatItCannotDo) {
  const Shape shape = grid(3);
  const Points& x = shape.vertices;
  Points broken = x;
  broken(4, 1) = std::nan("");
  const auto call = [&](const std::vector<Points>& keys, const InbetweenOptions& options = {}) {
    return inbetween(keys, uniform(3), shape.triangles, options);
  };
  EXPECT_REFUSAL(call({x}), "keys: at least two");
  EXPECT_REFUSAL(call({x, x.topRows(8)}), "keys[1] has 8 rows, expected 9");
  EXPECT_REFUSAL(call({x, broken}), "keys[1], row 4");
  InbetweenOptions options;
  options.key_times = Eigen::Vector2d(1.0, 1.0);
  EXPECT_REFUSAL(call({x, x}, options), "key_times, row 1");
  options.key_times = Eigen::Vector2d(-1e308, 1e308);
  EXPECT_REFUSAL(call({x, x}, options), "key_times, row 1: too far");
  options = {};
  options.turns = Eigen::MatrixXi::Constant(1, 1, 101);
  EXPECT_REFUSAL(call({x, x}, options), "turns, row 0");
  options.turns(0, 0) = std::numeric_limits<int>::min();
  EXPECT_REFUSAL(call({x, x}, options), "turns, row 0");
  options.turns = Eigen::MatrixXi::Zero(1, 2);
  EXPECT_REFUSAL(call({x, x}, options), "turns has 2 columns");
  options = {};
  options.anchors = {Eigen::VectorXi::Constant(1, 9)};
  EXPECT_REFUSAL(call({x, x}, options), "anchor, row 0");
  options = {};
  options.tolerance = 0.0;
  EXPECT_REFUSAL(call({x, x}, options), "tolerance");
  EXPECT_REFUSAL(inbetween({x, x}, Eigen::Vector2d(0.5, 1.5), shape.triangles), "times, row 1");
  EXPECT_REFUSAL(inbetween({x, x}, uniform(3), Triangles()), "triangles is empty");
  EXPECT_REFUSAL(inbetween({x, x}, uniform(3), Edges()), "edges is empty");
  EXPECT_REFUSAL(inbetween({x, x}, uniform(3), (Edges(2, 2) << 0, 1, 2, 2).finished()), "edges, row 1");
  EXPECT_REFUSAL(inbetween({x, x}, uniform(3), (Edges(1, 2) << 0, 9).finished()), "edges, row 0");
}

}  // namespace
}  // namespace planar::testing
