// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "planar/handle.h"
#include "planar/poser.h"

namespace planar {

/// No vertex moves by more than this share of the rest's diameter in one refine().
constexpr double refine_limit = 0.02;

/// Handles with all that a method needs to know of them, checked for sizes.
struct HandleSet {
  Handles handles;
  Eigen::VectorXd strength;               ///< k: of each handle; a patch's is shared out among its handles
  std::vector<char> patch;                ///< k flags: one of several handles of a pin
  std::vector<std::vector<int>> patches;  ///< the rows of each pin with several handles
};

/// Pairs of points of different parts that hang together.
struct JointSet {
  Handles first, second;     ///< k each
  Eigen::VectorXd strength;  ///< k
};

/// What a Poser asks of a method. Targets are checked. The methods start from positions x and write the new
/// ones there; they fill in iterations, substeps and converged of a new report. When one throws, the Poser
/// drops x and the report; the object itself may have lost what only saves time.
class PosingMethod {
 public:
  PosingMethod() = default;
  virtual ~PosingMethod() = default;
  PosingMethod(const PosingMethod&) = delete;
  PosingMethod& operator=(const PosingMethod&) = delete;

  /// Replaces the handles, or throws and keeps those of before.
  virtual void set_handles(const HandleSet& handles) = 0;
  /// Replaces the joints, or throws and keeps those of before. Handles stay.
  virtual void set_joints(const JointSet& /*joints*/) {
    throw std::invalid_argument("joints: only method hold has them");
  }
  virtual void move(const Points& targets, Points& x, Report& report) = 0;
  virtual void refine(const Points& targets, Points& x, Report& report) = 0;
  virtual void settle(const Points& targets, Points& x, Report& report) = 0;
  /// The positions are no longer those of the last call: forget what was derived from them.
  virtual void reset() noexcept = 0;
  /// Whether it fills in `flipped` of reports, too; else the Poser looks at all triangles.
  virtual bool counts_flipped() const { return false; }

  /// What calls ask that take longer than a move; empty: nobody wants to know.
  void set_progress(std::function<bool(double)> progress) { progress_ = std::move(progress); }

 protected:
  const std::function<bool(double)>& progress() const { return progress_; }

 private:
  std::function<bool(double)> progress_;
};

}  // namespace planar
