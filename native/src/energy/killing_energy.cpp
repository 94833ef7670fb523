// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/killing_energy.h"

#include <algorithm>
#include <cmath>

namespace planar {

namespace {

// Of the longest edge squared. It bounds the condition of the matrix at the present shape, where any triangle
// may be thin by now; which are flat at rest mesh/triangle_shape.h says.
constexpr double least_area = 1e-5;
constexpr double brace_stiffness = 1e-3;  // of a triangle in its place
constexpr double anchor = 1e-2;           // of a flat triangle's springs

}  // namespace

void KillingMatrix::assemble(const Points& x, const Eigen::VectorXd& stiffness,
                             const std::vector<char>& active) {
  set_zero();
  for (const Element& element : elements()) {
    if (!active[static_cast<std::size_t>(element.part)]) continue;
    add_element(element, x,
                element.triangle < 0 ? brace_stiffness
                : stiffness.size()   ? stiffness[element.triangle]
                                     : 1.0);
  }
  set_unit_rows(active);
}

void KillingMatrix::add_element(const Element& element, const Points& x, double stiffness) {
  const auto p = [&](std::size_t c) -> Eigen::Vector2d { return x.row(element.vertex[c]); };
  const std::array<Eigen::Vector2d, 3> side{p(2) - p(1), p(0) - p(2), p(1) - p(0)};
  const double longest = std::max({side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm()});
  const double doubled_area = std::abs(side[0].x() * side[1].y() - side[0].y() * side[1].x());
  const double floor = 2.0 * least_area * longest;
  if (!(doubled_area > floor)) add_springs(element, side, 2.0 * least_area * stiffness);
  if (longest == 0.0) return;

  // The gradient of corner c's hat function is its opposite side, turned by 90°, over the doubled area: (a,
  // b) / (2A).
  const double scale = stiffness / (2.0 * std::max(doubled_area, floor));
  double* value = values();
  for (std::size_t c = 0; c < 3; ++c) {
    const double a = -side[c].y(), b = side[c].x();
    value[element.diagonal[c]] += scale * (4.0 * a * a + 2.0 * b * b);
    value[element.diagonal[c] + 1] += scale * 2.0 * a * b;
    value[element.diagonal_y[c]] += scale * (4.0 * b * b + 2.0 * a * a);
  }
  constexpr std::array<std::array<std::size_t, 2>, 3> pairs{{{0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t s = 0; s < 3; ++s) {
    const double aj = -side[pairs[s][0]].y(), bj = side[pairs[s][0]].x();
    const double ai = -side[pairs[s][1]].y(), bi = side[pairs[s][1]].x();
    value[element.below[s]] += scale * (4.0 * ai * aj + 2.0 * bi * bj);
    value[element.below[s] + 1] += scale * 2.0 * ai * bj;
    value[element.below_y[s]] += scale * 2.0 * bi * aj;
    value[element.below_y[s] + 1] += scale * (4.0 * bi * bj + 2.0 * ai * aj);
  }
}

void KillingMatrix::add_springs(const Element& element, const std::array<Eigen::Vector2d, 3>& side,
                                double stiffness) {
  const double longest = std::max({side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm()});
  constexpr std::array<std::array<std::size_t, 2>, 3> ends{
      {{1, 2}, {0, 2}, {0, 1}}};  // of the side opposite to corner c
  constexpr std::array<std::size_t, 3> block_of_side{2, 1, 0};
  double* value = values();
  for (std::size_t c = 0; c < 3; ++c) {
    value[element.diagonal[c]] += anchor * stiffness;
    value[element.diagonal_y[c]] += anchor * stiffness;
  }
  for (std::size_t s = 0; s < 3; ++s) {
    const double length = side[s].squaredNorm();
    Eigen::Matrix2d spring = stiffness * Eigen::Matrix2d::Identity();
    if (length > 1e-24 * longest) spring = (stiffness / length) * side[s] * side[s].transpose();
    for (const std::size_t c : ends[s]) {
      value[element.diagonal[c]] += spring(0, 0);
      value[element.diagonal[c] + 1] += spring(1, 0);
      value[element.diagonal_y[c]] += spring(1, 1);
    }
    const std::size_t block = block_of_side[s];
    value[element.below[block]] -= spring(0, 0);
    value[element.below[block] + 1] -= spring(1, 0);
    value[element.below_y[block]] -= spring(0, 1);
    value[element.below_y[block] + 1] -= spring(1, 1);
  }
}

}  // namespace planar
