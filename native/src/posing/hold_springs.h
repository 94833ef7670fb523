// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "energy/newton_system.h"
#include "mesh/pin.h"

namespace planar {

/// What PoserMethod::hold adds to the rest energy: pins with their targets in Pin::position, lines, joints,
/// and what keeps parts on hinges from drifting.
struct HoldSprings final : Springs {
  /// Holds a vertex on the line normal · x = offset.
  struct LineSpring {
    int vertex;
    Eigen::RowVector2d normal;  ///< of length 1
    double offset;
    double strength;  ///< μ
  };

  /// Two points of different parts.
  struct Joint {
    Pin first, second;
    double strength;  ///< μ
  };

  /// μ of a vertex of parts on joints, to where it would be if all that hangs together moved as one: it
  /// decides how hinges turn where nothing else does. As much as what keeps factors regular
  /// (newton_system.cpp).
  static constexpr double return_strength = 1e-9;

  double value(const Points& x, Points* gradient) const override;
  void add_hessian(MeshMatrix& matrix, double scale) const override;

  std::vector<Pin> pins;
  std::vector<LineSpring> lines;
  std::vector<Joint> joints;  ///< of the parts that move
  std::vector<int> hanging;   ///< vertices of parts with joints that move
  Points reference;           ///< n×2: where these would be if all moved as one
};

}  // namespace planar
