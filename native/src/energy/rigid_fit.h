// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

namespace planar {

/// A point of a part, where it is to go, and how much that counts (above 0).
struct PointPair {
  int part;
  double weight;
  std::complex<double> from, to;
};

/// p -> to + e^{i angle} (p - from).
struct RigidMotion {
  std::complex<double> from = 0.0, to = 0.0;
  std::complex<double> turn = 1.0;  ///< e^{i angle}
  double angle = 0.0;

  std::complex<double> at(const std::complex<double>& p) const { return to + turn * (p - from); }

  /// What the motion leaves of the way from p to q: 0, to the bit, where it is none and q is p.
  std::complex<double> left(const std::complex<double>& p, const std::complex<double>& q) const {
    return q - to - turn * (p - from);
  }

  /// The motion up to a share of it, from 0 to 1.
  std::complex<double> at(const std::complex<double>& p, double share) const {
    return from + share * (to - from) + std::polar(1.0, share * angle) * (p - from);
  }
};

/// For each part of n_parts the rigid motion with the least Σ weight |at(from) - to|² over its pairs: from
/// one mean to the other, turned as S = Σ weight conj(from - mean) (to - mean) points. Where S is no more
/// than what rounding can make of it, no turn is better than another, and there is none: with a single pair,
/// with all points or all targets in one place, or with targets that are a mirror image of the points.
std::vector<RigidMotion> fit_rigid_motions(int n_parts, const std::vector<PointPair>& pairs);

}  // namespace planar
