// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/dense_polish.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <utility>

namespace planar {

namespace {

constexpr std::chrono::milliseconds between_looks{5};  // at whether to go on
/// Steps: the poses of three characters take 6 to 45, but for one that a cage leaves folded over.
constexpr int polish_budget = 60;
constexpr double usual_steps = 12.0;  // from a cage's pose: only progress depends on it

}  // namespace

struct DensePolish::Work {
  const Points rest;
  const Orientation& orientation;
  const Eigen::VectorXd stiffness;
  const JointSet joints;
  std::unique_ptr<HoldMethod> hold;  ///< once it is needed: a factor of the mesh is large

  Points targets, x;
  Report report;
  std::atomic<int> steps = 0;
  std::atomic<bool> abandoned = false;
};

DensePolish::DensePolish(const Points& rest, const Orientation& orientation, const Eigen::VectorXd& stiffness,
                         const JointSet& joints)
    : work_(new Work{rest, orientation, stiffness, joints, {}, {}, {}, {}}) {}

DensePolish::~DensePolish() { work_->abandoned = true; }

void DensePolish::set_handles(const HandleSet& handles) {
  handles_ = handles;
  new_handles_ = true;
}

void DensePolish::refine(const Points& targets, const std::function<bool(double)>& progress, Points& x,
                         Report& report) {
  act([](Work& work) { work.hold->advance(work.targets, work.x, work.report); }, targets, progress, x,
      report);
}

void DensePolish::settle(const Points& targets, const std::function<bool(double)>& progress, Points& x,
                         Report& report) {
  const auto settled = [](Work& work) {
    const auto before_step = [&work] {
      if (work.abandoned) throw Cancelled();
      ++work.steps;
    };
    work.hold->settle_within(polish_budget, before_step, work.targets, work.x, work.report);
  };
  act(settled, targets, progress, x, report);
}

void DensePolish::act(const Action& action, const Points& targets,
                      const std::function<bool(double)>& progress, Points& x, Report& report) {
  if (progress && !progress(0.0)) throw Cancelled();
  work_->steps = 0;
  wait(progress);  // for what was cancelled
  Work& work = *work_;
  work.targets = targets;
  work.x = x;
  work.report = {};
  work.abandoned = false;
  std::optional<HandleSet> handles;
  if (new_handles_) handles = handles_;
  new_handles_ = true;  // should it fail or be cancelled
  worker_.start([&work, action, handles = std::move(handles)] {
    if (!work.hold) {
      work.hold = std::make_unique<HoldMethod>(work.rest, work.orientation.triangles(), work.orientation,
                                               work.stiffness);
      if (work.joints.first.size() != 0) work.hold->set_joints(work.joints);
    }
    if (handles) work.hold->set_handles(*handles);
    work.hold->go_on();
    action(work);
  });
  try {
    wait(progress);
  } catch (...) {
    work.abandoned = true;
    throw;
  }
  worker_.finish();
  new_handles_ = false;
  std::swap(x, work.x);
  report = work.report;
}

void DensePolish::wait(const std::function<bool(double)>& progress) {
  if (!progress) {
    worker_.wait();
    return;
  }
  while (!worker_.wait_for(between_looks)) {
    if (!progress(std::min(1.0, work_->steps / usual_steps))) throw Cancelled();
  }
}

}  // namespace planar
