// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/triangle_guard.h"

#include <algorithm>

namespace planar {

namespace {

constexpr double unchanged = 8.0;  // |J|² + |J⁻¹|² up to which the energy is the paper's
constexpr double stiffest = 1e6;   // factor; more would cost digits in the factorization

}  // namespace

TriangleGuard::TriangleGuard(const Points& rest, const Triangles& triangles, const Flags& flat,
                             const Eigen::VectorXd& stiffness)
    : triangles_(triangles),
      painted_(stiffness.size() != 0 ? stiffness : Eigen::VectorXd::Ones(triangles.rows())),
      inverse_(static_cast<std::size_t>(triangles.rows())) {
  for (std::size_t t = 0; t < inverse_.size(); ++t) {
    if (flat[static_cast<Eigen::Index>(t)]) continue;
    const int* corner = triangles_.data() + 3 * t;
    const Eigen::RowVector2d a = rest.row(corner[1]) - rest.row(corner[0]);
    const Eigen::RowVector2d b = rest.row(corner[2]) - rest.row(corner[0]);
    const double area = a.x() * b.y() - a.y() * b.x();
    inverse_[t] = {b.y() / area, -b.x() / area, -a.y() / area, a.x() / area};
  }
}

void TriangleGuard::stiffness(const Points& x, Eigen::VectorXd& result) const {
  result = painted_;
  for (std::size_t t = 0; t < inverse_.size(); ++t) {
    const int* corner = triangles_.data() + 3 * t;
    const auto& inverse = inverse_[t];
    const double ax = x(corner[1], 0) - x(corner[0], 0), ay = x(corner[1], 1) - x(corner[0], 1);
    const double bx = x(corner[2], 0) - x(corner[0], 0), by = x(corner[2], 1) - x(corner[0], 1);
    const double xx = ax * inverse[0] + bx * inverse[2], xy = ax * inverse[1] + bx * inverse[3];
    const double yx = ay * inverse[0] + by * inverse[2], yy = ay * inverse[1] + by * inverse[3];
    const double det = xx * yy - xy * yx, square = det * det;
    // |J⁻¹|² = |J|²/det². Multiplied out, so that a collapsed triangle divides by nothing.
    const double energy = (xx * xx + xy * xy + yx * yx + yy * yy) * (square + 1.0);
    if (energy > unchanged * square) {
      const double ratio = energy / (unchanged * square);
      result[static_cast<Eigen::Index>(t)] *= ratio < 1e3 ? ratio * ratio : stiffest;
    }
  }
}

}  // namespace planar
