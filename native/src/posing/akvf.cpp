// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/akvf.h"

#include <utility>

#include "base/checks.h"
#include "posing/killing_solver.h"

namespace planar {

Points killing_field(const Points& vertices, const Triangles& triangles, const Handles& handles,
                     const Points& velocities, const KillingOptions& options) {
  require_mesh("vertices", vertices, triangles);
  require_rows("velocities", velocities.rows(), handles.size(), "handle");
  require_finite("velocities", velocities);
  const Eigen::VectorXd weights =
      Eigen::VectorXd::Constant(handles.size(), options.hard ? 1.0 : options.pin_weight);
  if (!options.hard) require_positive("pin_weight", Eigen::VectorXd::Constant(1, options.pin_weight));

  Mesh mesh(vertices.rows(), triangles);
  require_stiffness(options.stiffness, triangles);

  KillingSolver solver(std::move(mesh), {.hard = options.hard, .dirichlet = options.dirichlet});
  solver.use(solver.compile(handles, weights));
  Points field;
  solver.prepare(vertices, options.stiffness);
  solver.solve(velocities, field);
  return field;
}

}  // namespace planar
