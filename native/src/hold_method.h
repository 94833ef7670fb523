// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "killing_energy.h"
#include "mesh.h"
#include "orientation.h"
#include "pin.h"
#include "posing_method.h"
#include "rest_energy.h"
#include "sparse_solver.h"

namespace planar {

/// PoserMethod::hold: descends the rest energy and the handles' springs, see planar/poser.h.
class HoldMethod final : public PosingMethod {
 public:
  /// \param stiffness m factors, or empty
  HoldMethod(const Points& rest, const Triangles& triangles, const Eigen::VectorXd& stiffness);

  void set_handles(const HandleSet& handles) override;
  void move(const Points& targets, Points& x, Report& report) override;
  void refine(const Points& targets, Points& x, Report& report) override;
  void settle(const Points& targets, Points& x, Report& report) override;
  void reset() noexcept override { factor_ = Factor::none; }

 private:
  struct Budget {
    int steps;
    int factors;
    double limit;  ///< to how far a vertex may move
  };
  enum class Factor { none, newton, killing };

  void descend(const Points& targets, const Budget& budget, Points& x, Report& report);
  void set_targets(const Points& targets);
  bool follow_rigidly(double limit, Points& x);
  double pull(const Points& x, Points* gradient) const;
  double energy(const Points& x) const;
  void factorize(Factor kind, const Points& x);
  void solve();
  bool keeps_upright(const Points& x);

  Mesh mesh_;
  std::unique_ptr<SparseSolver> solver_;
  KillingMatrix matrix_;
  Orientation orientation_;
  RestEnergy rest_energy_;
  Eigen::VectorXd stiffness_;
  double diagonal_;

  std::vector<Pin> pins_;
  std::vector<char> active_;  ///< per part: it has a pin
  Factor factor_ = Factor::none;
  int age_ = 0;  ///< steps taken with the factor

  Points gradient_, direction_, trial_;  // of the step under way
  Eigen::VectorXd unknown_;
  std::vector<double> area_, trial_area_;
};

}  // namespace planar
