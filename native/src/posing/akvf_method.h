// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/orientation.h"
#include "posing/handle_motion.h"
#include "posing/killing_solver.h"
#include "posing/posing_method.h"
#include "posing/spirals.h"
#include "posing/triangle_guard.h"

namespace planar {

/// PoserMethod::akvf: fields along logarithmic spirals, see planar/poser.h.
class AkvfMethod final : public PosingMethod {
 public:
  /// \param orientation of the rest, to outlive the object
  /// \param stiffness m factors, or empty
  AkvfMethod(const Points& rest, Triangles triangles, const Orientation& orientation,
             const Eigen::VectorXd& stiffness);

  void set_handles(const HandleSet& handles) override;
  void move(const Points& targets, Points& x, Report& report) override;
  void refine(const Points& targets, Points& x, Report& report) override;
  void settle(const Points& targets, Points& x, Report& report) override;
  void reset() noexcept override {}

 private:
  void carry(const Points& targets, Points& x, Report& report);
  bool keeps_upright(const Points& x);
  void step(const Points& targets, Points& x, Report& report);
  bool substep(const Points& targets, Points& x, double limit, Report& report);
  void prepare(const Points& x);
  bool advance(double t);
  double furthest(const Points& x, const Points& targets) const;

  double size_;
  KillingSolver solver_;
  Spirals spirals_;
  const Orientation& orientation_;
  TriangleGuard guard_;
  Handles handles_;
  std::vector<std::vector<int>> part_rows_;  ///< of each part's handles
  std::vector<MovingTogether> together_;

  Points next_, field_;  // of the substep under way
  Eigen::VectorXd stiffness_;
  std::vector<double> upright_, next_upright_;  ///< areas as float32, see Orientation::measure
  std::vector<double> area_, next_area_;        ///< and as they are
};

}  // namespace planar
