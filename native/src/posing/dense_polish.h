// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>

#include "mesh/orientation.h"
#include "parallel/worker.h"
#include "posing/hold_method.h"
#include "posing/posing_method.h"

namespace planar {

/// HoldMethod on a mesh of its own, for calls that take so long that who waits for one may want to end it. It
/// works in a thread of its own: a call that is cancelled returns at once, and what is under way ends by
/// itself before the next call begins.
class DensePolish {
 public:
  /// \param rest n×2
  /// \param orientation to outlive the object
  /// \param stiffness m factors, or empty
  /// \param joints checked
  DensePolish(const Points& rest, const Orientation& orientation, const Eigen::VectorXd& stiffness,
              const JointSet& joints);
  ~DensePolish();

  void set_handles(const HandleSet& handles);
  /// A few steps. Each call begins with a factor of its own, so that one that was cancelled leaves no trace.
  ///
  /// \throw Cancelled `progress` returned false; x stays
  void refine(const Points& targets, const std::function<bool(double)>& progress, Points& x, Report& report);
  /// All of them.
  void settle(const Points& targets, const std::function<bool(double)>& progress, Points& x, Report& report);

 private:
  struct Work;  ///< all that the thread uses

  using Action = std::function<void(Work&)>;
  void act(const Action& action, const Points& targets, const std::function<bool(double)>& progress,
           Points& x, Report& report);
  void wait(const std::function<bool(double)>& progress);

  std::shared_ptr<Work> work_;
  HandleSet handles_;
  bool new_handles_ = true;
  Worker worker_;  ///< last, so that its thread ends before what it uses
};

}  // namespace planar
