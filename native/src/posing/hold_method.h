// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "energy/newton.h"
#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "parallel/worker.h"
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
  /// Pins with their targets in Pin::position.
  struct PinSprings final : Springs {
    double value(const Points& x, Points* gradient) const override;
    void add_hessian(MeshMatrix& matrix, double scale) const override;
    std::vector<Pin> pins;
  };

  Newton::Budget two_steps(double limit) const;
  void descend(const Points& targets, const Newton::Budget& budget, Points& x, Report& report);
  bool follow_rigidly(double limit, Points& x);

  Mesh mesh_;
  PinSprings springs_;
  Newton newton_;
  Points trial_;
  Points ahead_;   ///< where the next factor is made
  Worker worker_;  ///< last, so that its thread ends before what it uses
};

}  // namespace planar
