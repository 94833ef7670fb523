// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>

namespace planar {

/// What is added to a quantity on its way from one key (u = 0) to the next (u = 1) so that it meets them with
/// other slopes: a cubic that is 0 at both. Outside of them it goes on straight.
template <typename Value>
struct SlopeChange {
  Value first{}, last{};  ///< of the slopes, per u

  Value at(double u) const {
    if (u <= 0.0) return u * first;
    if (u >= 1.0) return (u - 1.0) * last;
    return u * (1.0 - u) * ((1.0 - u) * first - u * last);
  }
};

/// Time from the key before to a key, and on to the next one, in a unit of about the longer of the two:
/// slopes of keys that are 1e-200 apart would overflow in theirs.
struct KeyGaps {
  double before, after;
};

/// Of ascending times whose differences are finite.
KeyGaps key_gaps(double before, double key, double after);

/// The slope of a quantity through a key that it comes to with slope a and would leave with slope b, both per
/// unit of the gaps: a weighted harmonic mean, 0 where the signs differ. It is at most three times the lesser
/// of the two, so that what rests or turns back at the key does so without overshoot [Fritsch84].
double slope_through_key(double a, double b, KeyGaps gaps);

/// The same for places: the mean of the two directions at the mean of the speeds.
std::complex<double> slope_through_key(std::complex<double> a, std::complex<double> b, KeyGaps gaps);

/// Has a quantity come to a key and leave it with one slope. `before` and `after` are the slopes per u that
/// it has there without the changes, which are filled in.
template <typename Value>
void meet_at_key(Value before, Value after, KeyGaps gaps, SlopeChange<Value>& change_before,
                 SlopeChange<Value>& change_after) {
  const Value slope = slope_through_key(before / gaps.before, after / gaps.after, gaps);
  change_before.last = slope * gaps.before - before;
  change_after.first = slope * gaps.after - after;
}

/// A place's way from one key to the next.
struct Line {
  std::complex<double> from, way;
  SlopeChange<std::complex<double>> change{};

  std::complex<double> at(double u) const { return from + u * way + change.at(u); }
};

}  // namespace planar
