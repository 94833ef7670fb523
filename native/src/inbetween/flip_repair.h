// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "inbetween/frame_tracker.h"
#include "mesh/edge_graph.h"
#include "parallel/thread_team.h"

namespace planar {

/// Keeps the triangles of a transition from flipping between two keys in which they lie the same way round.
///
/// The frames of such a transition are tracked as a whole, those before the middle from the first key on, the
/// others from the second, each starting from its neighbour; single ones would pop. Parts that are not
/// PartCondition::failing are left alone.
class FlipRepair {
 public:
  /// The frames at several u, before repair.
  using Frames = std::function<std::vector<Points>(const Eigen::VectorXd& u)>;

  /// \param steps of the transition's grid
  /// \param progress called with the share of the work done; may throw
  FlipRepair(const EdgeGraph& graph, const Points& from, const Points& to, Eigen::Index steps,
             const Frames& frames, const std::function<void(double)>& progress, ThreadTeam& team);

  bool needed() const { return trackers_ != nullptr; }

  /// Parts that are PartCondition::hopeless.
  const std::vector<int>& hopeless_parts() const { return hopeless_; }
  /// Whether each tracked frame converged.
  bool converged() const { return converged_; }

  /// The frame at u, which is y before repair. Different threads may call it at once.
  Points repaired(const Points& y, double u, std::size_t thread) const;

 private:
  std::vector<int> hopeless_;
  bool converged_ = true;
  std::vector<Points> frames_, tracked_;               ///< at uniform u, keys included; before, after repair
  std::unique_ptr<PerThread<FrameTracker>> trackers_;  ///< none if there is nothing to repair
};

}  // namespace planar
