// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/arap.h"

#include "base/checks.h"
#include "posing/arap_method.h"

namespace planar {

ArapSteps arap_two_step(const Points& rest, const Triangles& triangles, const Handles& handles,
                        const Points& targets, double handle_weight, ArapWeights weights) {
  require_mesh("rest", rest, triangles);
  require_triangles(rest.rows(), triangles);
  require_rows("targets", targets.rows(), handles.size(), "handle");
  require_finite("targets", targets);
  require_positive("handle_weight", Eigen::VectorXd::Constant(1, handle_weight));
  ArapMethod method(rest, triangles, {}, weights);
  method.set_handles({handles, Eigen::VectorXd::Constant(handles.size(), handle_weight), {}, {}});
  ArapSteps steps{rest, rest};
  method.two_steps(targets, steps.final, &steps.similar);
  return steps;
}

}  // namespace planar
