// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <stdexcept>

/// Planar deformation methods. Every function follows the same rules:
///  - lengths are in the caller's unit, angles in radians; nothing depends on the unit or the origin of the
///  coordinates;
///  - `std::invalid_argument` reports the caller's data and names the argument and its row;
///  - `SolveError` reports a numerical failure; after any exception an object is as it was before the call;
///  - nothing prints, exits or keeps global state; one object is used by one thread at a time, objects are
///  independent;
///  - equal input gives equal bits;
///  - [AKVF 8] is equation (8) of the paper with that key in docs/references.md.
namespace planar {

/// n×2 positions or velocities, one row a vertex.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// n×3 positions in space, one row a vertex.
using SpacePoints = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// m×3 vertex indices (from 0). Orientation may differ from triangle to triangle.
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// m×2 vertex indices (from 0).
using Edges = Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// One truth a row.
using Flags = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// The numbers were valid, but the method failed on them (a singular system, an overflow, no memory for a
/// factor).
struct SolveError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The progress callback asked to stop.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace planar
