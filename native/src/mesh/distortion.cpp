// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/distortion.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "base/checks.h"
#include "mesh/orientation.h"
#include "mesh/triangle_shape.h"

namespace planar {

Distortion distortion(const Points& rest, const Points& posed, const Triangles& triangles) {
  require_mesh("rest", rest, triangles);
  require_rows("posed", posed.rows(), rest.rows(), "vertex of rest");
  require_float32("rest", rest);
  require_float32("posed", posed);
  require_triangles(rest.rows(), triangles);

  const Eigen::VectorXd none = Eigen::VectorXd::Constant(triangles.rows(), 2.0);
  const Flags flat = flat_triangles(rest, triangles);
  Distortion result{0.0, 0.0, 0, none, none, Orientation(rest, triangles, flat).flipped(posed)};
  result.flipped = static_cast<int>(result.triangle_flipped.count());
  const auto sides = [&triangles](const Points& x, Eigen::Index t) {
    Eigen::Matrix2d columns;
    columns.col(0) = x.row(triangles(t, 1)) - x.row(triangles(t, 0));
    columns.col(1) = x.row(triangles(t, 2)) - x.row(triangles(t, 0));
    return columns;
  };
  // Smaller ones have no area in float32.
  constexpr double least =
      double{std::numeric_limits<float>::denorm_min()} * std::numeric_limits<float>::denorm_min();
  double total = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (flat[t]) continue;
    const Eigen::Matrix2d before = sides(rest, t);
    const double weight = std::abs(before.determinant());
    if (weight < least) continue;
    const Eigen::Matrix2d after = sides(posed, t), jacobian = after * before.inverse();
    const double scale = std::abs(after.determinant()) / weight;  // of thin ones J's entries could overflow
    // σ₁² + σ₂² = |J|², σ₁σ₂ = |det J|
    result.triangle_area[t] = scale + 1.0 / scale;
    result.triangle_angle[t] = scale > 0.0 ? jacobian.squaredNorm() / scale : INFINITY;
    result.area += weight * result.triangle_area[t];
    result.angle += weight * result.triangle_angle[t];
    total += weight;
  }
  result.area = total > 0.0 ? result.area / total : 2.0;
  result.angle = total > 0.0 ? result.angle / total : 2.0;
  return result;
}

}  // namespace planar
