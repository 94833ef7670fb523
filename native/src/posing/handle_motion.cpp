// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/handle_motion.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double nearly_rigid = 0.05;  // what a rigid motion may leave of the largest distance

Complex at(const Points& points, int row) { return {points(row, 0), points(row, 1)}; }

/// (e^{ia} - 1)/(ia): what velocities that turn with rate a come to in unit time.
Complex turning(double a) {
  return std::abs(a) < 1e-4 ? Complex(1.0 - a * a / 6.0, a / 2.0)
                            : Complex(std::sin(a), 1.0 - std::cos(a)) / a;
}

}  // namespace

Points velocities_towards(const Points& from, const Points& to, const std::vector<MovingTogether>& sets) {
  Points velocity = to - from;
  std::vector<char> done(static_cast<std::size_t>(from.rows()));
  for (const MovingTogether& set : sets) {
    if (set.rows.size() < 2 || done[static_cast<std::size_t>(set.rows[0])]) continue;
    Complex centre = 0.0, target = 0.0, turn = 0.0;
    for (const int row : set.rows) {
      centre += at(from, row) / static_cast<double>(set.rows.size());
      target += at(to, row) / static_cast<double>(set.rows.size());
    }
    for (const int row : set.rows) turn += (at(to, row) - target) * std::conj(at(from, row) - centre);
    const double angle = std::arg(turn);
    const Complex rotation = std::polar(1.0, angle);
    const auto left = [&](int row) { return at(to, row) - target - rotation * (at(from, row) - centre); };
    double most_left = 0.0, distance = 0.0;
    for (const int row : set.rows) {
      most_left = std::max(most_left, std::abs(left(row)));
      distance = std::max(distance, std::abs(at(to, row) - at(from, row)));
    }
    if (!set.always && !(most_left <= nearly_rigid * distance)) continue;
    const Complex drift = (target - centre) / turning(angle);
    for (const int row : set.rows) {
      const Complex u = Complex(0.0, angle) * (at(from, row) - centre) + drift + left(row);
      velocity.row(row) << u.real(), u.imag();
      done[static_cast<std::size_t>(row)] = 1;
    }
  }
  return velocity;
}

}  // namespace planar
