// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "planar/arap.h"
#include "posing/posing_method.h"
#include "posing/two_step.h"

namespace planar {

/// PoserMethod::arap: two linear steps from the rest, see planar/poser.h and planar/arap.h.
class ArapMethod final : public PosingMethod {
 public:
  /// \param stiffness m factors, or empty
  ArapMethod(const Points& rest, const Triangles& triangles, const Eigen::VectorXd& stiffness,
             ArapWeights weights);

  void set_handles(const HandleSet& handles) override;
  void move(const Points& targets, Points& x, Report& report) override;
  void refine(const Points& targets, Points& x, Report& report) override;
  void settle(const Points& targets, Points& x, Report& report) override;
  void reset() noexcept override {}

  /// Both steps; parts without pins stay at x, which becomes the result.
  void two_steps(const Points& targets, Points& x, Points* similar = nullptr);

 private:
  using Pins = std::vector<Pin>;
  std::vector<char> determined_parts(const Pins& pins) const;
  void take_targets(const Points& targets);
  void solve_similar();
  void place(Points& x) const;

  double unit_;  ///< of the lengths below, so that their squares are numbers whatever the caller's unit
  Points rest_;
  double size_;
  Mesh mesh_;
  TwoStep solver_;
  Pins pins_;  ///< Pin::position: their targets, relative to the part's mean one
  bool factored_ = true;
  std::vector<char> pinned_, determined_;   ///< by part: has pins; its pins say how it is to be turned
  std::vector<Eigen::RowVector2d> centre_;  ///< by part: the mean target
  std::vector<Eigen::RowVector2d> start_;   ///< by part: where the mean target is at rest
  std::vector<std::complex<double>> numbers_;
};

}  // namespace planar
