// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "inbetween/blended_triangles.h"
#include "inbetween/frame_relaxation.h"
#include "inbetween/frame_tracker.h"
#include "inbetween/inbetween_support.h"

namespace planar::testing {
namespace {

/// Frames between two keys, to be relaxed.
struct Frames {
  Frames(Shape shape_, Points to_) : shape(std::move(shape_)), to(std::move(to_)) {}

  std::vector<Points> relaxed(
      std::vector<Points> frames, const std::function<void(double)>& progress = [](double) {},
      int threads = 2) const {
    ThreadTeam team(threads);
    const EdgeGraph graph(to.rows(), shape.triangles);
    relax_frames(graph, shape.vertices, to, u(frames.size()), frames, progress, team);
    return frames;
  }

  static Eigen::VectorXd u(std::size_t inner) {
    return uniform(static_cast<int>(inner) + 2).segment(1, static_cast<Eigen::Index>(inner));
  }

  double energy(const Points& x, double share) const {
    return FrameTracker(shape.triangles, shape.vertices, to).energy_of(x, share);
  }

  Shape shape;
  Points to;
};

Frames rolled_bar() {
  const Shape shape = bar(16, 0.15);
  return {shape, rolled(shape.vertices, 80.0 * degrees)};
}

/// Frames near to the bar on its way, with some error.
std::vector<Points> disturbed_frames(const Frames& frames, double error) {
  std::vector<Points> result;
  for (const double u : Frames::u(7)) {
    Points x = rolled(frames.shape.vertices, u * 80.0 * degrees);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      const auto phase = static_cast<double>(i);
      x.row(i) += error * Eigen::RowVector2d(std::sin(3.0 * phase), std::cos(5.0 * phase));
    }
    result.push_back(x);
  }
  return result;
}

TEST(FrameRelaxation, LessensTheEnergyOfEveryFrame) {
  const Frames frames = rolled_bar();
  const std::vector<Points> before = disturbed_frames(frames, 2e-3), after = frames.relaxed(before);
  const Eigen::VectorXd u = Frames::u(before.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double share = u[static_cast<Eigen::Index>(k)];
    // Near the minimum the energy is quadratic: a Newton step takes nearly all of the disturbance's away.
    EXPECT_LT(frames.energy(after[k], share), 0.5 * frames.energy(before[k], share)) << k;
  }
}

TEST(FrameRelaxation, LeavesWhatIsBestAlready) {
  const Shape shape = bar(16, 0.15);
  std::vector<Points> before;
  for (const double u : Frames::u(7)) {
    before.push_back(rigid_motion(shape.vertices, u * 50.0 * degrees, 0.3 * u, -0.1 * u));
  }
  const Frames frames(shape, rigid_motion(shape.vertices, 50.0 * degrees, 0.3, -0.1));
  EXPECT_LT(largest_difference(frames.relaxed(before), before), 1e-9);
}

TEST(FrameRelaxation, LeavesPlaces) {
  const Frames frames = rolled_bar();
  const std::vector<Points> before = disturbed_frames(frames, 2e-3), after = frames.relaxed(before);
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_LT((after[k].colwise().mean() - before[k].colwise().mean()).norm(), 1e-9) << k;
  }
}

TEST(FrameRelaxation, IsTheSameWithTimeReversed) {
  const Frames frames = rolled_bar();
  std::vector<Points> before = disturbed_frames(frames, 2e-3);
  std::vector<Points> after = frames.relaxed(before);
  std::reverse(before.begin(), before.end());
  std::reverse(after.begin(), after.end());
  const Frames reversed({frames.to, frames.shape.triangles}, frames.shape.vertices);
  EXPECT_LT(largest_difference(reversed.relaxed(before), after), 1e-9);
}

TEST(FrameRelaxation, DoesNotDependOnThreads) {
  const Frames frames = rolled_bar();
  const std::vector<Points> before = disturbed_frames(frames, 2e-3);
  const auto quietly = [](double) {};
  EXPECT_EQ(largest_difference(frames.relaxed(before, quietly, 1), frames.relaxed(before, quietly, 3)), 0.0);
}

TEST(FrameRelaxation, LeavesPartsWithFlipsAlone) {
  const Frames frames = rolled_bar();
  std::vector<Points> before = disturbed_frames(frames, 2e-3);
  before[3].row(4) += Eigen::RowVector2d(0.3, 0.2);
  EXPECT_EQ(largest_difference(frames.relaxed(before), before), 0.0);
}

TEST(FrameRelaxation, CanBeCancelled) {
  const Frames frames = rolled_bar();
  const auto stop = [](double done) {
    if (done > 0.0) throw Cancelled();
  };
  EXPECT_THROW(frames.relaxed(disturbed_frames(frames, 2e-3), stop), Cancelled);
}

}  // namespace
}  // namespace planar::testing
