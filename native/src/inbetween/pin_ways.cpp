// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/pin_ways.h"

#include <cmath>
#include <numbers>

#include "base/complex_rows.h"
#include "base/index.h"
#include "energy/rigid_fit.h"

namespace planar {

PinWays::PinWays(const Points& from, const Points& to, const std::vector<PinRows>& pins,
                 const Eigen::VectorXd& turns)
    : n_handles_(from.rows()) {
  std::vector<PointPair> pairs;
  for (std::size_t p = 0; p < pins.size(); ++p) {
    for (const int row : pins[p]) {
      pairs.push_back({static_cast<int>(p), 1.0, complex_row(from, row), complex_row(to, row)});
    }
  }
  const std::vector<RigidMotion> motions = fit_rigid_motions(static_cast<int>(pins.size()), pairs);
  for (std::size_t p = 0; p < pins.size(); ++p) {
    const RigidMotion& motion = motions[p];
    constexpr double whole = 2.0 * std::numbers::pi;
    const double wanted = turns[static_cast<Eigen::Index>(p)];
    Pin pin{pins[p], {motion.from, motion.to - motion.from}, motion.angle, {}, {}};
    pin.turn += whole * std::round((wanted - motion.angle) / whole);
    for (const int row : pin.rows) {
      const Complex first = complex_row(from, row) - motion.from;
      const Complex last = std::conj(motion.turn) * (complex_row(to, row) - motion.to);
      pin.handles.push_back({first, last - first});
    }
    pins_.push_back(std::move(pin));
  }
}

Points PinWays::at(double u) const {
  Points result(n_handles_, 2);
  for (const Pin& pin : pins_) {
    const Complex turn = std::polar(1.0, u * pin.turn + pin.turn_change.at(u));
    for (std::size_t i = 0; i < pin.rows.size(); ++i) {
      const Complex place = pin.middle.at(u) + turn * pin.handles[i].at(u);
      result.row(pin.rows[i]) << place.real(), place.imag();
    }
  }
  return result;
}

void PinWays::join(PinWays& before, PinWays& after, const std::vector<char>& pins, KeyGaps gaps) {
  for (std::size_t p = 0; p < pins.size(); ++p) {
    if (!pins[p]) continue;
    Pin &a = before.pins_[p], &b = after.pins_[p];
    meet_at_key(a.middle.way, b.middle.way, gaps, a.middle.change, b.middle.change);
    meet_at_key(a.turn, b.turn, gaps, a.turn_change, b.turn_change);
    // What is turned before the key is seen from behind it.
    const Complex turn = std::polar(1.0, a.turn);
    for (std::size_t i = 0; i < a.handles.size(); ++i) {
      Line &first = a.handles[i], &second = b.handles[i];
      meet_at_key(turn * first.way, second.way, gaps, first.change, second.change);
      first.change.last *= std::conj(turn);
    }
  }
}

}  // namespace planar
