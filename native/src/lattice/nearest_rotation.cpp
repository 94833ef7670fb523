// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/nearest_rotation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace planar {

Eigen::Matrix2d nearest_rotation(const Eigen::Matrix2d& s) {
  const double c = s(0, 0) + s(1, 1), d = s(0, 1) - s(1, 0), square = c * c + d * d;
  // The root is ten times as fast, and good where the square neither overflows nor loses digits.
  const double size = square > 1e-280 && square < 1e300 ? std::sqrt(square) : std::hypot(c, d);
  Eigen::Matrix2d r = Eigen::Matrix2d::Identity();
  if (size > 0.0) r << c / size, -d / size, d / size, c / size;
  return r;
}

namespace {

constexpr int newton_budget = 30;

/// The largest root of the characteristic polynomial of a symmetric matrix without trace, from above, where
/// Newton's iteration runs down to it without a detour.
double largest_eigenvalue(const Eigen::Matrix4d& n, double above) {
  const Eigen::Matrix4d square = n * n;
  const double c2 = -0.5 * square.trace();
  const double c1 = -square.cwiseProduct(n).sum() / 3.0;
  const double c0 = n.determinant();
  double x = above;
  for (int i = 0; i < newton_budget; ++i) {
    const double x2 = x * x;
    const double value = (x2 + c2) * x2 + c1 * x + c0, slope = (4.0 * x2 + 2.0 * c2) * x + c1;
    if (!(slope > 0.0)) break;
    const double step = value / slope;
    x -= step;
    if (std::abs(step) <= 1e-15 * above) break;
  }
  return x;
}

}  // namespace

/// The rotation's quaternion is the eigenvector of the largest eigenvalue of a 4×4 matrix [Horn87]. It is
/// a column of the adjugate at that eigenvalue, polished by one step of inverse iteration; where that has
/// lost its digits, as two eigenvalues are nearly the same, the matrix is diagonalised.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& s) {
  const double size = s.norm();
  if (!(size > 0.0)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d a = s / size;
  Eigen::Matrix4d n;
  n << a(0, 0) + a(1, 1) + a(2, 2), a(1, 2) - a(2, 1), a(2, 0) - a(0, 2), a(0, 1) - a(1, 0),  //
      a(1, 2) - a(2, 1), a(0, 0) - a(1, 1) - a(2, 2), a(0, 1) + a(1, 0), a(2, 0) + a(0, 2),   //
      a(2, 0) - a(0, 2), a(0, 1) + a(1, 0), a(1, 1) - a(0, 0) - a(2, 2), a(1, 2) + a(2, 1),   //
      a(0, 1) - a(1, 0), a(2, 0) + a(0, 2), a(1, 2) + a(2, 1), a(2, 2) - a(0, 0) - a(1, 1);
  const double largest = largest_eigenvalue(n, std::sqrt(3.0));  // Σ σ ≤ √3 |S|
  // The adjugate of N - λ, whose columns are multiples of the eigenvector: the column of its largest diagonal
  // entry has no cancellation.
  Eigen::Matrix4d shifted = n;
  shifted.diagonal().array() -= largest;
  Eigen::Vector4d q;
  double best = 0.0;
  for (int c = 0; c < 4; ++c) {
    Eigen::Vector4d column;
    for (int r = 0; r < 4; ++r) {
      Eigen::Matrix3d minor;
      for (int i = 0, k = 0; i < 4; ++i) {
        if (i == r) continue;
        for (int j = 0, l = 0; j < 4; ++j) {
          if (j != c) minor(k, l++) = shifted(i, j);
        }
        ++k;
      }
      column[r] = ((r + c) % 2 == 0 ? 1.0 : -1.0) * minor.determinant();
    }
    if (column.squaredNorm() <= best) continue;
    best = column.squaredNorm();
    q = column;
    if (best > 0.01) break;
  }
  if (best > 1e-8) {
    q.normalize();
    // Off by what the eigenvalue's last digits do to it: a step of inverse iteration with Rayleigh's quotient
    // doubles the digits.
    Eigen::Matrix4d again = n;
    again.diagonal().array() -= q.dot(n * q) + 1e-14;
    const Eigen::Vector4d polished = again.partialPivLu().solve(q);
    if (polished.allFinite() && polished.squaredNorm() > 0.0) q = polished.normalized();
  } else {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(n);
    q = eigen.eigenvectors().col(3);
  }
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace planar
