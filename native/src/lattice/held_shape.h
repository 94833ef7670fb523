// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "planar/types.h"

namespace planar {

/// J of a triangle, by rows, with what its energy s + s/δ² is made of: δ = det J, s = |J|². It is |J|² +
/// |J⁻¹|².
struct Jacobian {
  std::array<double, 4> entry;

  double delta() const { return entry[0] * entry[3] - entry[1] * entry[2]; }
  double square() const {
    return entry[0] * entry[0] + entry[1] * entry[1] + entry[2] * entry[2] + entry[3] * entry[3];
  }
  /// |J|² + |J⁻¹|² - 4, which is 0 for rotations; infinite where δ is not above 0.
  double value() const;
  /// Its derivatives by the entries.
  std::array<double, 4> slope() const;
  /// Its Hessian, made semidefinite: only its eigenvalue along the twist t, λ = 2 - 2(s - δ)/δ³, can be
  /// negative, and -λ t tᵀ is added where it is. t = (-r_s, -r_c, r_c, -r_s)/√2 with r_c, r_s the cosine and
  /// sine of the polar rotation.
  std::array<std::array<double, 4>, 4> form() const;
};

/// The rest shape whose symmetric Dirichlet energy E = Σ A_t (|J|² + |J⁻¹|² - 4) [Smith15] "hold" keeps low.
/// It works on displacements from rest, u (n×2), so that nothing depends on where the rest lies: J = I +
/// Σ_c u_c ∇φ_c. Triangles that are flat at rest are carried along, as a lattice does, and count for nothing.
class HeldShape {
 public:
  struct Triangle {
    std::array<int, 3> vertex;
    double g1x, g1y, g2x, g2y;  ///< gradients at rest of the hat functions of corners 1 and 2
    double area;

    /// Of corner c.
    std::array<double, 2> gradient(int c) const {
      if (c == 0) return {-(g1x + g2x), -(g1y + g2y)};
      return c == 1 ? std::array<double, 2>{g1x, g1y} : std::array<double, 2>{g2x, g2y};
    }
    /// What u adds to J.
    std::array<double, 4> change(const Points& u) const {
      const double* u0 = u.data() + 2 * static_cast<std::ptrdiff_t>(vertex[0]);
      const double* u1 = u.data() + 2 * static_cast<std::ptrdiff_t>(vertex[1]);
      const double* u2 = u.data() + 2 * static_cast<std::ptrdiff_t>(vertex[2]);
      const double x1 = u1[0] - u0[0], y1 = u1[1] - u0[1], x2 = u2[0] - u0[0], y2 = u2[1] - u0[1];
      return {g1x * x1 + g2x * x2, g1y * x1 + g2y * x2, g1x * y1 + g2x * y2, g1y * y1 + g2y * y2};
    }
    Jacobian jacobian(const Points& u) const {
      const std::array<double, 4> c = change(u);
      return {{1.0 + c[0], c[1], c[2], 1.0 + c[3]}};
    }
  };

  HeldShape(const Points& rest, const Triangles& triangles, const Flags& flat);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Of all of them.
  double area() const { return area_; }

  double value(const Points& u) const;
  /// The value, and its n×2 derivatives.
  double gradient(const Points& u, Points& result) const;
  bool is_upright(const Points& u) const;

  struct Collapse {
    double t = 0.0;  ///< infinite: not before 4
    int triangle = -1;
  };
  /// The first triangle without area on the way u + t du, t > 0; those without any at u do not count.
  Collapse first_collapse(const Points& u, const Points& du) const;

 private:
  Points rest_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<int, 3>> corners_;  ///< of each, counter-clockwise at rest
  double area_ = 0.0;
};

}  // namespace planar
