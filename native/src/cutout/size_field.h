// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cutout/outline_field.h"

namespace planar {

/// How far the polygon may be from the outline, in samples. The first keeps every sample inside, the second
/// keeps polygons on both sides of a gap apart.
struct Band {
  double inward, outward;

  explicit Band(const OutlineField& field);
  /// Whether all of the straight line lies in it.
  bool holds(const Grid<float>& distance, const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) const;
};

/// Points of the rings that contours are made even to, in samples.
constexpr double ring_step = 0.75;

/// Lengths of edges, in samples: of each sample what thickness and outline ask for, before what is wished.
struct SizeField {
  Grid<float> size;

  /// \param rings even, ring_step
  /// \param shortest, longest sizes are between these
  SizeField(const OutlineField& field, const std::vector<Points>& rings, const Band& band, double shortest,
            double longest);

  /// The edge for which a mesh has so many vertices, at most `longest`, at least `shortest`.
  double edge_for(double vertices) const;

  /// How many vertices a mesh with this longest edge has.
  double vertices_for(double edge) const;

  void limit(double edge);

 private:
  struct Bin {
    double size, area, length;  ///< samples of this size: inside, and along the rings
  };
  std::vector<Bin> bins_;
  double shortest_, longest_;
};

}  // namespace planar
