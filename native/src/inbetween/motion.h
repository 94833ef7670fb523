// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "inbetween/flip_repair.h"
#include "inbetween/frame_assembler.h"
#include "inbetween/midpoint_transition.h"
#include "inbetween/part_placer.h"
#include "inbetween/pinned_transition.h"
#include "mesh/edge_graph.h"
#include "parallel/per_thread.h"
#include "parallel/thread_team.h"
#include "planar/inbetween.h"

namespace planar {

/// Where a time lies: at a share u of the way from key k to the next.
struct Moment {
  std::size_t k;
  double u;
};

/// All transitions between keys, solved; see planar/inbetween.h.
class Motion {
 public:
  /// \param options checked
  /// \param ties one a transition
  /// \param pins in place of those of the options; null: none
  Motion(const std::vector<Points>& shapes, EdgeGraph edge_graph, const InbetweenOptions& options,
         const std::vector<Ties>& ties, std::unique_ptr<FramePins> pins);

  /// Frames at moments that are not keys'.
  /// \param path where the pins' handles (k×2) are to be at moments[i], where that is a number; null: nowhere
  /// else than by themselves
  std::vector<Points> sample(const std::vector<Moment>& moments,
                             const std::function<const Points*(std::size_t i)>& path);

  /// Between two calls of progress.
  std::size_t frames_at_a_time() const;
  Eigen::Index pin_handles() const { return pins_ ? pins_->handles.size() : 0; }

  const Eigen::VectorXd& key_times() const { return times_; }
  ThreadTeam& threads() { return team_; }
  const std::vector<TransitionReport>& report() const { return reports_; }

 private:
  /// What moves from keys[k] to keys[k+1].
  struct Transition {
    MidpointTransition edges;
    PartPlacer placer;
    std::unique_ptr<FlipRepair> repair;      ///< none if there is nothing to repair
    std::unique_ptr<PinnedTransition> pins;  ///< none if there are no pins
  };

  /// Of the work on one transition, which is done in halves: first all are solved, then all are repaired.
  std::function<void(double)> progress_of(const InbetweenOptions& options, double begin, std::size_t k) const;
  void join_transitions();
  void repair(std::size_t k, const std::function<void(double)>& progress);
  void hold_pins(Points& frame, const Moment& moment, const Points* path, std::size_t thread);
  /// Frames at moments, a pass for FrameAssembler::lanes of them.
  std::vector<Points> frames(const std::vector<Moment>& moments, bool repaired);

  std::vector<Points> keys_;
  Eigen::VectorXd times_;
  EdgeGraph graph_;
  FrameAssembler assembler_;
  ThreadTeam team_;
  std::unique_ptr<FramePins> pins_;  ///< none if there are no pins
  std::vector<Transition> transitions_;
  std::vector<TransitionReport> reports_;
  std::unique_ptr<PerThread<PinHolder>> holders_;  ///< where there are pins
};

}  // namespace planar
