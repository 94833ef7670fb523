// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/rigid_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.h"

namespace planar {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Of a point's distance from the origin: a point inside a triangle is a sum of three products whose weights
/// are rounded, too, which is off by up to half of this.
constexpr double rounding = 4.0 * epsilon;

/// What is summed over the pairs of a part.
struct Sums {
  double count = 0.0, weight = 0.0;
  double largest_from = 0.0, largest_to = 0.0;  ///< distances from the origin
  std::complex<double> turn = 0.0;              ///< S
  // About the means: Σ weight |from|, Σ weight |to|, Σ weight |from| |to|.
  double spread_from = 0.0, spread_to = 0.0, product = 0.0;

  /// By how much S may be off: the points by their own rounding, the sum by that of its terms.
  double rounding_of_turn() const {
    const double off_from = rounding * largest_from, off_to = rounding * largest_to;
    return off_from * spread_to + off_to * spread_from + off_from * off_to * weight +
           count * epsilon * product;
  }
};

}  // namespace

std::vector<RigidMotion> fit_rigid_motions(int n_parts, const std::vector<PointPair>& pairs) {
  std::vector<RigidMotion> motions(at(n_parts));
  std::vector<Sums> sums(motions.size());
  for (const PointPair& pair : pairs) {
    RigidMotion& motion = motions[at(pair.part)];
    Sums& sum = sums[at(pair.part)];
    motion.from += pair.weight * pair.from;
    motion.to += pair.weight * pair.to;
    sum.weight += pair.weight;
    sum.count += 1.0;
    sum.largest_from = std::max(sum.largest_from, std::abs(pair.from));
    sum.largest_to = std::max(sum.largest_to, std::abs(pair.to));
  }
  for (std::size_t part = 0; part < motions.size(); ++part) {
    if (sums[part].weight == 0.0) continue;
    motions[part].from /= sums[part].weight;
    motions[part].to /= sums[part].weight;
  }
  for (const PointPair& pair : pairs) {
    const RigidMotion& motion = motions[at(pair.part)];
    Sums& sum = sums[at(pair.part)];
    const std::complex<double> p = pair.from - motion.from, q = pair.to - motion.to;
    const double p_size = pair.weight * std::abs(p), q_size = std::abs(q);
    sum.turn += pair.weight * std::conj(p) * q;
    sum.spread_from += p_size;
    sum.spread_to += pair.weight * q_size;
    sum.product += p_size * q_size;
  }
  for (std::size_t part = 0; part < motions.size(); ++part) {
    const double size = std::abs(sums[part].turn);
    if (!(size > sums[part].rounding_of_turn())) continue;
    motions[part].turn = sums[part].turn / size;
    motions[part].angle = std::arg(sums[part].turn);
  }
  return motions;
}

}  // namespace planar
