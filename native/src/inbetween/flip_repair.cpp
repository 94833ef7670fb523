// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/flip_repair.h"

#include <algorithm>
#include <cmath>

#include "inbetween/part_condition.h"

namespace planar {

namespace {

constexpr Eigen::Index frames_per_step = 4;
constexpr double tracked_tolerance = 1e-4;  // these are only where others start
constexpr double tolerance = 1e-5;

}  // namespace

FlipRepair::FlipRepair(const EdgeGraph& graph, const Points& from, const Points& to, Eigen::Index steps,
                       const Frames& frames, const std::function<void(double)>& progress, ThreadTeam& team) {
  if (graph.triangles.rows() == 0) return;
  const Eigen::Index last = frames_per_step * steps;
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(last + 1, 0.0, 1.0);
  frames_ = frames(u);
  const auto conditions = conditions_of_parts(graph, from, to, frames_, u, team);
  for (std::size_t part = 0; part < conditions.size(); ++part) {
    if (conditions[part] == PartCondition::hopeless) hopeless_.push_back(static_cast<int>(part));
  }
  const Triangles triangles = triangles_of_parts(graph, conditions, PartCondition::failing);
  if (triangles.rows() == 0) return;
  auto trackers = FrameTracker::one_a_thread(team, triangles, from, to);
  tracked_ = frames_;
  std::vector<char> converged(frames_.size(), 1);
  const auto step = [&](Eigen::Index k, Eigen::Index neighbour, std::size_t thread) {
    const Points& y = frames_[static_cast<std::size_t>(k)];
    const auto start = static_cast<std::size_t>(neighbour);
    tracked_[static_cast<std::size_t>(k)] =
        trackers.of(thread).follow(tracked_[start], frames_[start], y, u[k], tracked_tolerance);
    converged[static_cast<std::size_t>(k)] = trackers.of(thread).converged();
  };
  // Both ways in step, so that progress can be told in this thread.
  for (Eigen::Index k = 1; k <= last / 2; ++k) {
    progress(static_cast<double>(2 * k) / static_cast<double>(last));
    team.run(2 * k == last ? 1 : 2, [&](std::size_t way, std::size_t thread) {
      way == 0 ? step(k, k - 1, thread) : step(last - k, last - k + 1, thread);
    });
  }
  converged_ = std::all_of(converged.begin(), converged.end(), [](char does) { return does != 0; });
  trackers_ = std::make_unique<PerThread<FrameTracker>>(std::move(trackers));
}

Points FlipRepair::repaired(const Points& y, double u, std::size_t thread) const {
  const auto start = static_cast<std::size_t>(std::round(u * static_cast<double>(tracked_.size() - 1)));
  return trackers_->of(thread).follow(tracked_[start], frames_[start], y, u, tolerance);
}

}  // namespace planar
