// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "inbetween/key_slopes.h"
#include "planar/types.h"

namespace planar {

/// Handles that are one pin, in rows of a table of handles: a single one, or those of a patch.
using PinRows = std::vector<int>;

/// Where pins go between two keys when nobody says otherwise: straight, what stands in both stands. A patch
/// goes by the rigid motion that takes it nearest to where it is in the second key, its middle straight and
/// turned evenly, and takes on the rest of the way what that motion leaves.
class PinWays {
 public:
  /// \param from, to k×2: the handles in the two keys
  /// \param pins their rows
  /// \param turns one a pin: radians by which the mesh turns there, whole turns included; a patch, of which
  /// its handles do not tell whole turns, turns as nearly so as they allow
  PinWays(const Points& from, const Points& to, const std::vector<PinRows>& pins,
          const Eigen::VectorXd& turns);

  /// k×2: the handles at u, 0 at the first key and 1 at the second, or beyond them.
  Points at(double u) const;

  /// Has the ways of those pins (a flag a pin) meet the key between two transitions with the same velocities.
  static void join(PinWays& before, PinWays& after, const std::vector<char>& pins, KeyGaps gaps);

 private:
  using Complex = std::complex<double>;

  struct Pin {
    PinRows rows;
    Line middle;
    double turn;
    SlopeChange<double> turn_change{};
    std::vector<Line> handles;  ///< from the middle, seen from what is turned
  };

  std::vector<Pin> pins_;
  Eigen::Index n_handles_;
};

}  // namespace planar
