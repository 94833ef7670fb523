// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "planar/types.h"

namespace planar {

/// Which way round triangles lie, judged on positions rounded to float32, which is what Blender stores.
class Orientation {
 public:
  /// Takes the orientation of `rest` as the right one. Triangles that are `flat` (m), or thinner than what
  /// float32 makes of their coordinates, are not judged.
  ///
  /// \param origin what the positions given to the functions below are relative to
  Orientation(const Points& rest, const Triangles& triangles, Flags flat,
              const Eigen::RowVector2d& origin = Eigen::RowVector2d::Zero());

  /// Takes counter-clockwise as the right one, for triangles that have no plane at rest. All but those that
  /// are `flat` are judged.
  Orientation(const Triangles& triangles, Flags flat);

  const Triangles& triangles() const { return triangles_; }
  const Flags& flat() const { return flat_; }

  /// Twice the area of each triangle at x, positive if it lies as at rest, exactly 1 if it is not judged.
  void measure(const Points& x, std::vector<double>& area) const;

  /// The same of x as it is. Far from the origin, rounding to float32 changes areas long before it turns
  /// triangles over.
  void measure_exactly(const Points& x, std::vector<double>& area) const;

  /// Whether each triangle lies the other way round at x.
  Flags flipped(const Points& x) const;

  /// Whether triangle t does.
  bool is_flipped(const Points& x, int t) const {
    return area_as_at_rest(x, static_cast<std::size_t>(t)) < 0.0;
  }

  /// Triangles that lie the other way round at x.
  int count_flipped(const Points& x) const;

 private:
  /// Twice the area in float32, positive if t lies as at rest; 0 if it is not judged.
  double area_as_at_rest(const Points& x, std::size_t t) const;

  Triangles triangles_;
  Flags flat_;
  Eigen::RowVector2d origin_;
  std::vector<double> sign_;  ///< of the rest: 1, -1, or 0 if not judged
};

}  // namespace planar
