// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/handle_motion.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/complex_rows.h"
#include "base/index.h"
#include "energy/rigid_fit.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double nearly_rigid = 0.05;  // what a rigid motion may leave of the largest distance

/// (e^{ia} - 1)/(ia): what velocities that turn with rate a come to in unit time.
Complex turning(double a) {
  return std::abs(a) < 1e-4 ? Complex(1.0 - a * a / 6.0, a / 2.0)
                            : Complex(std::sin(a), 1.0 - std::cos(a)) / a;
}

}  // namespace

Points velocities_towards(const Points& from, const Points& to, const std::vector<MovingTogether>& sets) {
  Points velocity = to - from;
  std::vector<char> done(at(from.rows()));
  std::vector<PointPair> pairs;
  for (const MovingTogether& set : sets) {
    if (set.rows.size() < 2) continue;
    pairs.clear();
    for (const int row : set.rows) pairs.push_back({0, 1.0, complex_row(from, row), complex_row(to, row)});
    const RigidMotion motion = fit_rigid_motions(1, pairs).front();
    double most_left = 0.0, distance = 0.0;
    for (const PointPair& pair : pairs) {
      most_left = std::max(most_left, std::abs(motion.left(pair.from, pair.to)));
      distance = std::max(distance, std::abs(pair.to - pair.from));
    }
    if (!set.always && !(most_left <= nearly_rigid * distance)) continue;
    const Complex drift = (motion.to - motion.from) / turning(motion.angle);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (done[at(set.rows[i])]) continue;
      const Complex u = Complex(0.0, motion.angle) * (pairs[i].from - motion.from) + drift +
                        motion.left(pairs[i].from, pairs[i].to);
      velocity.row(set.rows[i]) << u.real(), u.imag();
      done[at(set.rows[i])] = 1;
    }
  }
  return velocity;
}

}  // namespace planar
