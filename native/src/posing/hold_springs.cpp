// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/hold_springs.h"

namespace planar {

double HoldSprings::value(const Points& x, Points* gradient) const {
  double sum = 0.0;
  for (const Pin& pin : pins) {
    const Eigen::RowVector2d left = pinned_point(pin, x) - pin.position;
    sum += pin.strength * left.squaredNorm();
    if (gradient == nullptr) continue;
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      gradient->row(pin.vertex[c]) += 2.0 * pin.strength * pin.weight[c] * left;
    }
  }
  for (const Joint& joint : joints) {
    const Eigen::RowVector2d left = pinned_point(joint.first, x) - pinned_point(joint.second, x);
    sum += joint.strength * left.squaredNorm();
    if (gradient == nullptr) continue;
    const Eigen::RowVector2d force = 2.0 * joint.strength * left;
    for (std::size_t c = 0; c < joint.first.n_corners; ++c) {
      gradient->row(joint.first.vertex[c]) += joint.first.weight[c] * force;
    }
    for (std::size_t c = 0; c < joint.second.n_corners; ++c) {
      gradient->row(joint.second.vertex[c]) -= joint.second.weight[c] * force;
    }
  }
  for (const int v : hanging) {
    const Eigen::RowVector2d left = x.row(v) - reference.row(v);
    sum += return_strength * left.squaredNorm();
    if (gradient != nullptr) gradient->row(v) += 2.0 * return_strength * left;
  }
  for (const LineSpring& line : lines) {
    const double left = line.normal.dot(x.row(line.vertex)) - line.offset;
    sum += line.strength * left * left;
    if (gradient != nullptr) gradient->row(line.vertex) += 2.0 * line.strength * left * line.normal;
  }
  return sum;
}

void HoldSprings::add_hessian(MeshMatrix& matrix, double scale) const {
  for (const Joint& joint : joints) {
    const auto add = [&](const Pin& pin, std::size_t a, const Pin& other, std::size_t b, double sign) {
      matrix.add(pin.vertex[a], other.vertex[b],
                 sign * 2.0 * scale * joint.strength * pin.weight[a] * other.weight[b]);
    };
    for (const Pin* pin : {&joint.first, &joint.second}) {
      for (std::size_t a = 0; a < pin->n_corners; ++a) {
        for (std::size_t b = 0; b <= a; ++b) add(*pin, a, *pin, b, 1.0);
      }
    }
    for (std::size_t a = 0; a < joint.first.n_corners; ++a) {
      for (std::size_t b = 0; b < joint.second.n_corners; ++b) add(joint.first, a, joint.second, b, -1.0);
    }
  }
  for (const int v : hanging) matrix.add(v, v, 2.0 * scale * return_strength);
  for (const Pin& pin : pins) {
    for (std::size_t a = 0; a < pin.n_corners; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        matrix.add(pin.vertex[a], pin.vertex[b], 2.0 * scale * pin.strength * pin.weight[a] * pin.weight[b]);
      }
    }
  }
  for (const LineSpring& line : lines) {
    matrix.add(line.vertex, 2.0 * scale * line.strength * line.normal.transpose() * line.normal);
  }
}

}  // namespace planar
