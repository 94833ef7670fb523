// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/frame_relaxation.h"

#include <algorithm>
#include <cmath>

#include "inbetween/frame_tracker.h"
#include "inbetween/part_condition.h"

namespace planar {

namespace {

constexpr int n_steps = 2;          // each takes nearly as long as all else
constexpr double margin = 0.5;      // of the way to a collapse: the frames between these are not looked at
constexpr double rounding = 1e-12;  // of the energy of the triangles at rest, 4 times their area
constexpr int most_halvings = 4;    // then the step is not worth it

/// A step of the same length for all frames; false if there is none that lessens the energy of each.
bool step(PerThread<FrameTracker>& trackers, const Eigen::VectorXd& u, std::vector<Points>& frames,
          const std::function<void(double)>& progress, ThreadTeam& team) {
  std::vector<FrameTracker::Step> steps(frames.size());
  const auto batch = static_cast<std::size_t>(team.size());
  for (std::size_t first = 0; first < frames.size(); first += batch) {
    progress(static_cast<double>(first) / static_cast<double>(frames.size()));
    try {
      team.run(std::min(batch, frames.size() - first), [&](std::size_t i, std::size_t thread) {
        const std::size_t k = first + i;
        steps[k] = trackers.of(thread).step_at(frames[k], u[static_cast<Eigen::Index>(k)]);
      });
    } catch (const SolveError&) {  // numbers as different as 1e-10 and 1: the frames are good enough
      return false;
    }
  }
  const double error = rounding * trackers.of(0).area();
  double t = 1.0;
  for (const FrameTracker::Step& found : steps) {
    if (!std::isfinite(found.energy) || !found.direction.allFinite()) return false;
    t = std::min(t, margin * found.collapse);
  }
  std::vector<Points> relaxed(frames.size());
  std::vector<char> lower(frames.size());
  for (int halvings = 0; halvings <= most_halvings; ++halvings, t *= 0.5) {
    team.run(frames.size(), [&](std::size_t k, std::size_t thread) {
      relaxed[k] = frames[k] + t * steps[k].direction;
      const double energy = trackers.of(thread).energy_of(relaxed[k], u[static_cast<Eigen::Index>(k)]);
      lower[k] = Newton::lessens(steps[k].energy, energy, t, steps[k].slope, error);
    });
    if (std::all_of(lower.begin(), lower.end(), [](char is) { return is != 0; })) {
      frames = std::move(relaxed);
      return true;
    }
  }
  return false;
}

}  // namespace

void relax_frames(const EdgeGraph& graph, const Points& from, const Points& to, const Eigen::VectorXd& u,
                  std::vector<Points>& frames, const std::function<void(double)>& progress,
                  ThreadTeam& team) {
  const auto conditions = conditions_of_parts(graph, from, to, frames, u, team);
  const Triangles triangles = triangles_of_parts(graph, conditions, PartCondition::sound);
  if (triangles.rows() == 0) return;
  auto trackers = FrameTracker::one_a_thread(team, triangles, from, to);
  for (int taken = 0; taken < n_steps; ++taken) {
    const auto share = [&](double done) { progress((taken + done) / n_steps); };
    if (!step(trackers, u, frames, share, team)) return;
  }
}

}  // namespace planar
