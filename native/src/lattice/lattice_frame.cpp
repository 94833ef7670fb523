// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/lattice_frame.h"

#include <cmath>

#include "base/checks.h"
#include "base/index.h"
#include "linear/least_squares.h"

namespace planar {

namespace {

constexpr double tolerance = 1e-3;  // of a step, or of the coordinates' own digits in float32
constexpr double float32_digits = 1e-6;

}  // namespace

LatticeFrame::LatticeFrame(const Coordinates& points)
    : origin_(points.row(0)), steps_(Eigen::MatrixXd::Zero(points.cols(), 3)) {
  const Eigen::Index n = points.rows();
  const double rounding = float32_digits * points.cwiseAbs().maxCoeff();
  Eigen::Index block = 1;  // points of what the axes so far make
  for (int axis = 0; axis < 3 && block < n; ++axis) {
    const Eigen::RowVectorXd step = points.row(block) - origin_;
    const auto fits = [&](Eigen::Index k) {
      const Eigen::RowVectorXd off = points.row(k * block) - origin_ - static_cast<double>(k) * step;
      return off.norm() <= tolerance * step.norm() + rounding;
    };
    Eigen::Index count = 2;
    while ((count + 1) * block <= n && fits(count)) ++count;
    if (axis == 2) count = n / block;
    steps_.col(axis) = step.transpose();
    count_[at(axis)] = static_cast<int>(count);
    block *= count;
  }
  const std::array<Eigen::Index, 3> c{count_[0], count_[1], count_[2]};
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::array<Eigen::Index, 3> index{i % c[0], i / c[0] % c[1], i / (c[0] * c[1])};
    const Eigen::Vector3d at_step(static_cast<double>(index[0]), static_cast<double>(index[1]),
                                  static_cast<double>(index[2]));
    const Eigen::RowVectorXd off = points.row(i) - origin_ - (steps_ * at_step).transpose();
    const bool outside = i >= c[0] * c[1] * c[2];
    if (outside || !(off.norm() <= tolerance * steps_.colwise().norm().maxCoeff() + rounding)) {
      throw std::invalid_argument(row_of("lattice_rest", i) + "not a point of a regular grid, u fastest");
    }
  }
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> LatticeFrame::in_steps(
    const Coordinates& places) const {
  const Eigen::MatrixXd inverse =
      least_squares(steps_, Eigen::MatrixXd::Identity(steps_.rows(), steps_.rows()));  // 3×D
  return (places.rowwise() - origin_) * inverse.transpose();
}

std::vector<Difference> second_differences(const std::array<int, 3>& count) {
  const std::array<int, 3> stride{1, count[0], count[0] * count[1]};
  std::vector<Difference> result;
  for (int point = 0; point < stride[2] * count[2]; ++point) {
    const std::array<int, 3> index{point % count[0], point / count[0] % count[1], point / stride[2]};
    for (std::size_t a = 0; a < 3; ++a) {
      if (index[a] > 0 && index[a] + 1 < count[a]) {
        result.push_back({{point - stride[a], point, point + stride[a]}, {1.0, -2.0, 1.0}});
      }
      for (std::size_t b = a + 1; b < 3; ++b) {
        if (index[a] + 1 >= count[a] || index[b] + 1 >= count[b]) continue;
        const double mixed = std::sqrt(2.0);
        result.push_back({{point, point + stride[a], point + stride[b], point + stride[a] + stride[b]},
                          {mixed, -mixed, -mixed, mixed}});
      }
    }
  }
  return result;
}

}  // namespace planar
