// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "mesh/mesh.h"
#include "mesh/orientation.h"
#include "posing/hold_system.h"
#include "posing/posing_method.h"

namespace planar {

/// PoserMethod::hold: descends the rest energy and the pins' springs, see planar/poser.h.
class HoldMethod final : public PosingMethod {
 public:
  /// \param orientation of the rest, to outlive the object
  /// \param stiffness m factors, or empty
  HoldMethod(const Points& rest, const Triangles& triangles, const Orientation& orientation,
             const Eigen::VectorXd& stiffness);

  void set_handles(const HandleSet& handles) override;
  void move(const Points& targets, Points& x, Report& report) override;
  void refine(const Points& targets, Points& x, Report& report) override;
  void settle(const Points& targets, Points& x, Report& report) override;
  void reset() noexcept override;

 private:
  struct Budget {
    int steps;
    int factors;
    bool ahead;    ///< make the next factor after the last step instead of during the steps
    double limit;  ///< to how far a vertex may move
  };
  /// A step along direction_ and what it comes to.
  struct Step {
    double length;    ///< of the longest displacement of a vertex, for t = 1
    double collapse;  ///< the t at which a triangle collapses
    double t = 0.0;
  };

  void descend(const Points& targets, const Budget& budget, Points& x, Report& report);
  void descend_steps(const Budget& budget, const Points& start, Points& x, Report& report);
  bool follow_rigidly(double limit, Points& x);
  double pull(const Points& x, Points* gradient) const;
  double energy(const Points& x) { return system_.rest_energy().value(x) + pull(x, nullptr); }
  void renew(const Points& x, int& factors);
  Step aim(const Points& x);
  void search(double value, double longest, Points& x, Step& step);
  bool keeps_upright(const Points& x);

  Mesh mesh_;
  const Orientation& orientation_;
  HoldSystem system_;
  double diagonal_;
  std::vector<Pin> pins_;  ///< with targets in Pin::position

  int age_ = 0;               ///< steps taken with the factor
  double last_length_ = 0.0;  ///< of the step before with it, infinite if that was not a full one
  bool slow_ = false;         ///< full steps with fresh factors do not get shorter
  int exact_pause_ = 0, exact_failures_ = 0;

  Points gradient_, direction_, trial_, further_;  // of the step under way
  std::vector<double> area_, trial_area_;
};

}  // namespace planar
