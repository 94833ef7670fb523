// SPDX-License-Identifier: GPL-3.0-or-later
#include "flip_repair.h"

#include <algorithm>
#include <cmath>

namespace planar {

namespace {

constexpr Eigen::Index frames_per_step = 4;
constexpr double most_strain = 3.0;       // of a triangle: it is about to collapse
constexpr double tracked_settled = 1e-4;  // these are only where others start
constexpr double settled = 1e-5;

}  // namespace

/// The triangles of the parts that need repair and can be repaired.
Triangles FlipRepair::failing(const EdgeGraph& graph, const Points& from, const Points& to,
                              const Eigen::VectorXd& u, ThreadTeam& team) const {
  const auto part_of = [&graph](std::size_t t) {
    return static_cast<std::size_t>(
        graph.part[static_cast<std::size_t>(graph.triangles(static_cast<Eigen::Index>(t), 0))]);
  };
  const auto n_parts = static_cast<std::size_t>(graph.n_parts);
  const Orientation upright(from, graph.triangles);
  const BlendedTriangles blended(from, to, graph.triangles);
  std::vector<std::vector<char>> fails(frames_.size(), std::vector<char>(n_parts));
  team.run(frames_.size(), [&](std::size_t k, std::size_t) {
    std::vector<double> area;
    upright.measure(frames_[k], area);
    for (std::size_t t = 0; t < area.size(); ++t) {
      char& failing = fails[k][part_of(t)];
      failing =
          failing || area[t] < 0.0 ||
          blended.strain(static_cast<int>(t), frames_[k], u[static_cast<Eigen::Index>(k)]) > most_strain;
    }
  });
  std::vector<double> area;
  upright.measure(to, area);
  const Orientation at_the_end(to, graph.triangles);
  std::vector<char> hopeless(n_parts);
  for (std::size_t t = 0; t < area.size(); ++t) {
    const auto number = static_cast<int>(t);
    if (area[t] < 0.0 || upright.judges(number) != at_the_end.judges(number)) hopeless[part_of(t)] = 1;
  }
  std::vector<int> rows;
  for (std::size_t t = 0; t < area.size(); ++t) {
    const std::size_t part = part_of(t);
    if (hopeless[part]) continue;
    if (std::any_of(fails.begin(), fails.end(), [part](const auto& frame) { return frame[part] != 0; })) {
      rows.push_back(static_cast<int>(t));
    }
  }
  return graph.triangles(rows, Eigen::all);
}

FlipRepair::FlipRepair(const EdgeGraph& graph, const Points& from, const Points& to, Eigen::Index steps,
                       const Frames& frames, const std::function<void(double)>& progress, ThreadTeam& team) {
  if (graph.triangles.rows() == 0) return;
  const Eigen::Index last = frames_per_step * steps;
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(last + 1, 0.0, 1.0);
  frames_ = frames(u);
  const Triangles triangles = failing(graph, from, to, u, team);
  if (triangles.rows() == 0) return;
  std::vector<std::unique_ptr<FrameTracker>> trackers;
  trackers.reserve(static_cast<std::size_t>(team.size()));
  for (int i = 0; i < team.size(); ++i) {
    trackers.push_back(std::make_unique<FrameTracker>(triangles, from, to));
  }
  tracked_ = frames_;
  const auto step = [&](Eigen::Index k, Eigen::Index neighbour, std::size_t thread) {
    const Points& y = frames_[static_cast<std::size_t>(k)];
    const auto start = static_cast<std::size_t>(neighbour);
    tracked_[static_cast<std::size_t>(k)] =
        trackers[thread]->follow(tracked_[start], frames_[start], y, u[k], tracked_settled);
  };
  // Both ways in step, so that progress can be told in this thread.
  for (Eigen::Index k = 1; k <= last / 2; ++k) {
    progress(static_cast<double>(2 * k) / static_cast<double>(last));
    team.run(2 * k == last ? 1 : 2, [&](std::size_t way, std::size_t thread) {
      way == 0 ? step(k, k - 1, thread) : step(last - k, last - k + 1, thread);
    });
  }
  trackers_ = std::move(trackers);
}

Points FlipRepair::repaired(const Points& y, double u, std::size_t thread) const {
  const auto start = static_cast<std::size_t>(std::round(u * static_cast<double>(tracked_.size() - 1)));
  return trackers_[thread]->follow(tracked_[start], frames_[start], y, u, settled);
}

}  // namespace planar
