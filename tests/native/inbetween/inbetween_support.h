// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "planar/inbetween.h"
#include "support.h"

/// Shapes and measures that the tests of in-betweening share.
namespace planar::testing {

constexpr double degrees = std::numbers::pi / 180.0;

/// A bar of length 1 and width `width`, lying along x, of `columns`×(2 rows of cells).
Shape bar(int columns, double width = 0.08);

/// The bar bent along its length into an arc of `angle`; its middle line keeps its length.
Points rolled(const Points& straight, double angle);

double wrapped_angle(double angle);

Eigen::VectorXd uniform(int frames, double last = 1.0);

double largest_difference(const Points& a, const Points& b);

double largest_difference(const std::vector<Points>& a, const std::vector<Points>& b);

/// A bar that is bent, turned and moved.
struct Bending {
  Shape shape = bar(30);
  std::vector<Points> frames =
      inbetween({shape.vertices, rigid_motion(rolled(shape.vertices, 200.0 * degrees), 0.4, 2.0, 1.0)},
                uniform(9), shape.triangles);
};

/// A mesh and its keys.
struct Sequence {
  Shape shape;
  std::vector<Points> keys;
  InbetweenOptions options;

  Inbetweens solved() const { return {keys, shape.triangles, options}; }
};

/// A bar, a square and an isolated vertex, bent and moved at uneven times; smooth.
/// \param seed of the square
Sequence bent(unsigned seed = 1);

/// The sides of a closed contour or, if `open`, all but the last.
Edges contour(int n, bool open = false);

}  // namespace planar::testing
