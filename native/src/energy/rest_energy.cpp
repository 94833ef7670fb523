// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/rest_energy.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double flat_stiffness = 3.0;  // of the springs of a flat triangle; 1 is the order of a good one
constexpr double needs_repair = 1e-3;   // det J
constexpr double repaired = 0.1;        // det J, and the χ of triangles below it

constexpr std::array<std::array<std::size_t, 2>, 3> pairs{{{0, 1}, {0, 2}, {1, 2}}};

/// ψ(δ) = 1 + χ(δ)⁻² with its derivatives; χ = (δ + √(ε² + δ²))/2, which is δ for ε = 0.
struct Barrier {
  double value, slope, curvature;
};

Barrier barrier(double delta, double softening) {
  if (softening == 0.0) {
    const double inverse = 1.0 / delta, square = inverse * inverse;
    return {1.0 + square, -2.0 * square * inverse, 6.0 * square * square};
  }
  const double root = std::sqrt(softening + delta * delta);
  // Without the cancellation of the formula above where δ < 0.
  const double chi = delta > 0.0 ? 0.5 * (delta + root) : 0.5 * softening / (root - delta);
  const double slope = chi / root, curvature = 0.5 * softening / (root * root * root);
  const double inverse = 1.0 / chi, square = inverse * inverse;
  return {1.0 + square, -2.0 * square * inverse * slope,
          6.0 * square * square * slope * slope - 2.0 * square * inverse * curvature};
}

}  // namespace

struct RestEnergy::Jacobian {
  double ax, ay, bx, by;  // a and b
  double square;          // s
  double delta;

  double value(const Barrier& psi) const { return square * psi.value - 4.0; }
  /// Derivatives of s ψ by |a| and |b|, over |a| and |b|.
  double along_a(const Barrier& psi) const { return 4.0 * psi.value + 2.0 * square * psi.slope; }
  double along_b(const Barrier& psi) const { return 4.0 * psi.value - 2.0 * square * psi.slope; }
};

inline RestEnergy::Jacobian RestEnergy::jacobian(const Triangle& triangle, const Points& x) {
  const double* p0 = x.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[0]);
  const double* p1 = x.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[1]);
  const double* p2 = x.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[2]);
  const double ux = p1[0] - p0[0], uy = p1[1] - p0[1];
  const double vx = p2[0] - p0[0], vy = p2[1] - p0[1];
  Jacobian j{};
  j.ax = (ux * triangle.g1x + uy * triangle.g1y) + (vx * triangle.g2x + vy * triangle.g2y);
  j.ay = (uy * triangle.g1x - ux * triangle.g1y) + (vy * triangle.g2x - vx * triangle.g2y);
  j.bx = (ux * triangle.g1x - uy * triangle.g1y) + (vx * triangle.g2x - vy * triangle.g2y);
  j.by = (ux * triangle.g1y + uy * triangle.g1x) + (vx * triangle.g2y + vy * triangle.g2x);
  j.square = 2.0 * ((j.ax * j.ax + j.ay * j.ay) + (j.bx * j.bx + j.by * j.by));
  j.delta = (ux * vy - uy * vx) * triangle.inverse;
  return j;
}

RestEnergy::RestEnergy(const Points& rest, const MeshMatrix& matrix, const Flags& flat,
                       const Eigen::VectorXd& stiffness)
    : RestEnergy([&rest](int, int v) -> Eigen::Vector2d { return rest.row(v); }, matrix, flat, stiffness) {}

RestEnergy::RestEnergy(const RestOf& rest_of, const MeshMatrix& matrix, const Flags& flat,
                       const Eigen::VectorXd& stiffness) {
  for (std::size_t i = 0; i < matrix.elements().size(); ++i) {
    const MeshMatrix::Element& element = matrix.elements()[i];
    if (element.triangle < 0) continue;
    const auto p = [&](std::size_t c) { return rest_of(element.triangle, element.vertex[c]); };
    const Eigen::Vector2d p0 = p(0), p1 = p(1), p2 = p(2);
    const std::array<Eigen::Vector2d, 3> side{p2 - p1, p0 - p2, p1 - p0};
    const double factor = stiffness.size() != 0 ? stiffness[element.triangle] : 1.0;
    if (flat[element.triangle]) {
      flat_.push_back({i, element.vertex, side, flat_stiffness * factor});
      continue;
    }
    Triangle triangle{i, element.vertex, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    const double area = side[2].x() * -side[1].y() + side[2].y() * side[1].x();
    // The gradient of corner c's hat function is its opposite side, turned by 90°, over twice the area.
    triangle.inverse = 1.0 / area;
    triangle.g1x = -0.5 * side[1].y() * triangle.inverse;
    triangle.g1y = 0.5 * side[1].x() * triangle.inverse;
    triangle.g2x = -0.5 * side[2].y() * triangle.inverse;
    triangle.g2y = 0.5 * side[2].x() * triangle.inverse;
    triangle.weight = 0.5 * factor * std::abs(area);
    triangles_.push_back(triangle);
  }
}

void RestEnergy::relax(const Points& x) {
  for (Triangle& triangle : triangles_) {
    triangle.softening = jacobian(triangle, x).delta < needs_repair ? 1.0 : 0.0;
  }
  tighten(x);
}

void RestEnergy::tighten(const Points& x) {
  for (Triangle& triangle : triangles_) {
    if (triangle.softening == 0.0) continue;
    // χ(δ) = c for ε² = 4c(c - δ).
    const double delta = jacobian(triangle, x).delta;
    triangle.softening = std::max(0.0, 4.0 * repaired * (repaired - delta));
  }
}

double RestEnergy::value(const Points& x) const {
  double sum = 0.0;
  for (const Triangle& triangle : triangles_) {
    const Jacobian j = jacobian(triangle, x);
    if (triangle.softening == 0.0) {
      if (!(j.delta > 0.0)) return std::numeric_limits<double>::infinity();
      sum += triangle.weight * (j.square + j.square / (j.delta * j.delta) - 4.0);
    } else {
      sum += triangle.weight * j.value(barrier(j.delta, triangle.softening));
    }
  }
  for (const FlatTriangle& flat : flat_) sum += add_flat_gradient(flat, x, nullptr);
  return sum;
}

double RestEnergy::gradient(const Points& x, Points& result) const {
  result.setZero(x.rows(), 2);
  double sum = 0.0;
  for (const Triangle& triangle : triangles_) {
    const Jacobian j = jacobian(triangle, x);
    const Barrier psi = barrier(j.delta, triangle.softening);
    sum += triangle.weight * j.value(psi);
    const double along_a = triangle.weight * j.along_a(psi), along_b = triangle.weight * j.along_b(psi);
    const double ax = along_a * j.ax, ay = along_a * j.ay, bx = along_b * j.bx, by = along_b * j.by;
    // By corner c: a g_c + b conj(g_c).
    const double px = (ax + bx) * triangle.g1x + (by - ay) * triangle.g1y;
    const double py = (ay + by) * triangle.g1x + (ax - bx) * triangle.g1y;
    const double qx = (ax + bx) * triangle.g2x + (by - ay) * triangle.g2y;
    const double qy = (ay + by) * triangle.g2x + (ax - bx) * triangle.g2y;
    double* r0 = result.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[0]);
    double* r1 = result.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[1]);
    double* r2 = result.data() + 2 * static_cast<std::ptrdiff_t>(triangle.vertex[2]);
    r0[0] -= px + qx;
    r0[1] -= py + qy;
    r1[0] += px;
    r1[1] += py;
    r2[0] += qx;
    r2[1] += qy;
  }
  for (const FlatTriangle& flat : flat_) sum += add_flat_gradient(flat, x, &result);
  return sum;
}

namespace {

/// The sides of a flat triangle at x and the rotation that takes its sides at rest nearest to them.
struct Turned {
  std::array<Complex, 3> rest, side;
  Complex rotation = 1.0;
  double agreement, size;  // Σ conj(rest) side, in modulus; Σ |rest|²

  Turned(const std::array<Eigen::Vector2d, 3>& rest_side, const std::array<int, 3>& vertex, const Points& x)
      : size(0.0) {
    Complex sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Eigen::RowVector2d e = x.row(vertex[(c + 2) % 3]) - x.row(vertex[(c + 1) % 3]);
      rest[c] = {rest_side[c].x(), rest_side[c].y()};
      side[c] = {e.x(), e.y()};
      sum += std::conj(rest[c]) * side[c];
      size += std::norm(rest[c]);
    }
    agreement = std::abs(sum);
    if (agreement > 0.0) rotation = sum / agreement;
  }
};

}  // namespace

double RestEnergy::add_flat_gradient(const FlatTriangle& flat, const Points& x, Points* result) const {
  const Turned turned(flat.side, flat.vertex, x);
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const Complex left = turned.side[c] - turned.rotation * turned.rest[c];
    sum += flat.weight * std::norm(left);
    if (result == nullptr) continue;
    const Eigen::RowVector2d force = 2.0 * flat.weight * Eigen::RowVector2d(left.real(), left.imag());
    result->row(flat.vertex[(c + 2) % 3]) += force;
    result->row(flat.vertex[(c + 1) % 3]) -= force;
  }
  return sum;
}

namespace {

/// The blocks of a triangle: a sum of outer products of four vectors, each times its eigenvalue.
struct Blocks {
  std::array<std::array<Complex, 3>, 4> mode;  ///< by mode and corner
  std::array<double, 4> eigenvalue;

  void add_to(double* value, const MeshMatrix::Element& element) const {
    std::array<std::array<Complex, 3>, 4> scaled;
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t c = 0; c < 3; ++c) scaled[k][c] = eigenvalue[k] * mode[k][c];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      double xx = 0.0, xy = 0.0, yy = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        xx += scaled[k][c].real() * mode[k][c].real();
        xy += scaled[k][c].real() * mode[k][c].imag();
        yy += scaled[k][c].imag() * mode[k][c].imag();
      }
      value[element.diagonal[c]] += xx;
      value[element.diagonal[c] + 1] += xy;
      value[element.diagonal_y[c]] += yy;
    }
    for (std::size_t s = 0; s < 3; ++s) {
      double xx = 0.0, yx = 0.0, xy = 0.0, yy = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        const Complex later = scaled[k][pairs[s][1]], earlier = mode[k][pairs[s][0]];
        xx += later.real() * earlier.real();
        yx += later.imag() * earlier.real();
        xy += later.real() * earlier.imag();
        yy += later.imag() * earlier.imag();
      }
      value[element.below[s]] += xx;
      value[element.below[s] + 1] += yx;
      value[element.below_y[s]] += xy;
      value[element.below_y[s] + 1] += yy;
    }
  }
};

}  // namespace

void RestEnergy::add_hessian(const Points& x, const std::vector<char>& active, MeshMatrix& matrix,
                             Hessian kind) const {
  double* value = matrix.values();
  for (const Triangle& triangle : triangles_) {
    const MeshMatrix::Element& element = matrix.elements()[triangle.element];
    if (!active[at(element.part)]) continue;
    const Jacobian j = jacobian(triangle, x);
    const Barrier psi = barrier(j.delta, triangle.softening);
    const double p = std::sqrt(j.ax * j.ax + j.ay * j.ay), q = std::sqrt(j.bx * j.bx + j.by * j.by);
    // Along a and b the Hessian is λ₁ (a c₁ + b s₁)² + λ₂ (a c₂ + b s₂)².
    double first, second, c1 = 1.0, s1 = 1.0, c2 = 1.0, s2 = -1.0;
    if (triangle.softening == 0.0) {
      // The second derivatives of Σ σ² + σ⁻² by the singular values |a| ± |b|.
      const double large = p + q, from_large = 1.0 / large, from_small = large * (1.0 / j.delta);
      const double large_2 = from_large * from_large, small_2 = from_small * from_small;
      first = 2.0 + 6.0 * large_2 * large_2;
      second = 2.0 + 6.0 * small_2 * small_2;
    } else {
      const double curved = 4.0 * j.square * psi.curvature;
      const double pp = j.along_a(psi) + p * p * (16.0 * psi.slope + curved);
      const double qq = j.along_b(psi) + q * q * (-16.0 * psi.slope + curved);
      const double pq = -p * q * curved;
      const double angle = 0.5 * std::atan2(2.0 * pq, pp - qq);
      c1 = s2 = std::cos(angle);
      s1 = std::sin(angle);
      c2 = -s1;
      const double mean = 0.5 * (pp + qq), radius = std::hypot(0.5 * (pp - qq), pq);
      first = std::max(0.0, mean + radius);
      second = std::max(0.0, mean - radius);
    }
    const double along_a = j.along_a(psi);
    const double twist =
        kind == Hessian::projected || triangle.softening != 0.0 ? std::max(0.0, along_a) : along_a;
    const double shear = std::max(0.0, j.along_b(psi));
    const double from_p = p > 0.0 ? 1.0 / p : 0.0, from_q = q > 0.0 ? 1.0 / q : 0.0;
    const double ax = p > 0.0 ? j.ax * from_p : 1.0, ay = j.ay * from_p;
    const double bx = q > 0.0 ? j.bx * from_q : 1.0, by = j.by * from_q;

    Blocks blocks;
    blocks.eigenvalue = {triangle.weight * first, triangle.weight * second, triangle.weight * shear,
                         triangle.weight * twist};
    const std::array<double, 2> gx{triangle.g1x, triangle.g2x}, gy{triangle.g1y, triangle.g2y};
    for (std::size_t c = 0; c < 2; ++c) {
      // a g and b conj(g), with a and b of length 1.
      const double rax = ax * gx[c] - ay * gy[c], ray = ay * gx[c] + ax * gy[c];
      const double rbx = bx * gx[c] + by * gy[c], rby = by * gx[c] - bx * gy[c];
      blocks.mode[0][c + 1] = {c1 * rax + s1 * rbx, c1 * ray + s1 * rby};
      blocks.mode[1][c + 1] = {c2 * rax + s2 * rbx, c2 * ray + s2 * rby};
      blocks.mode[2][c + 1] = {-rby, rbx};
      blocks.mode[3][c + 1] = {-ray, rax};
    }
    for (auto& m : blocks.mode) m[0] = -(m[1] + m[2]);
    blocks.add_to(value, element);
  }

  for (const FlatTriangle& flat : flat_) {
    const MeshMatrix::Element& element = matrix.elements()[flat.element];
    if (!active[at(element.part)]) continue;
    const Turned turned(flat.side, flat.vertex, x);
    // 2 (I - q qᵀ / r) over the sides, q = iR e_rest, r = |Σ conj(e_rest) e|; with r ≥ |q|² it is
    // semidefinite.
    const double spring = 2.0 * flat.weight;
    const double r = std::max(turned.agreement, turned.size);
    const double scale = r > 0.0 ? spring / r : 0.0;
    std::array<Complex, 3> turn;
    for (std::size_t c = 0; c < 3; ++c) {
      turn[c] = Complex(0.0, 1.0) * turned.rotation * (turned.rest[(c + 1) % 3] - turned.rest[(c + 2) % 3]);
      value[element.diagonal[c]] += 2.0 * spring - scale * turn[c].real() * turn[c].real();
      value[element.diagonal[c] + 1] -= scale * turn[c].real() * turn[c].imag();
      value[element.diagonal_y[c]] += 2.0 * spring - scale * turn[c].imag() * turn[c].imag();
    }
    for (std::size_t s = 0; s < 3; ++s) {
      const Complex i = turn[pairs[s][1]], j = turn[pairs[s][0]];
      value[element.below[s]] -= spring + scale * i.real() * j.real();
      value[element.below[s] + 1] -= scale * i.imag() * j.real();
      value[element.below_y[s]] -= scale * i.real() * j.imag();
      value[element.below_y[s] + 1] -= spring + scale * i.imag() * j.imag();
    }
  }
}

double RestEnergy::first_collapse(const Points& x, const Points& direction) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : triangles_) {
    const auto side = [&triangle](const Points& points, std::size_t end) -> Eigen::RowVector2d {
      return points.row(triangle.vertex[end]) - points.row(triangle.vertex[0]);
    };
    const Eigen::RowVector2d u = side(x, 1), v = side(x, 2), du = side(direction, 1), dv = side(direction, 2);
    // det J(t) = c0 + c1 t + c2 t²
    const double c0 = (u.x() * v.y() - u.y() * v.x()) * triangle.inverse;
    if (!(c0 > 0.0)) continue;
    const double c1 =
        ((u.x() * dv.y() - u.y() * dv.x()) + (du.x() * v.y() - du.y() * v.x())) * triangle.inverse;
    const double c2 = (du.x() * dv.y() - du.y() * dv.x()) * triangle.inverse;
    const double discriminant = c1 * c1 - 4.0 * c0 * c2;
    if (discriminant < 0.0) continue;
    // The least positive root, in the form that does not cancel and holds for c2 = 0 as well.
    const double q = std::sqrt(discriminant) - c1;
    if (q > 0.0 && 2.0 * c0 < least * q) least = 2.0 * c0 / q;
  }
  return least;
}

}  // namespace planar
