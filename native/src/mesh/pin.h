// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "mesh/mesh.h"
#include "planar/handle.h"

namespace planar {

/// A point of the mesh and the rows of handles that lie on it.
struct Pin {
  std::array<int, 3> vertex;     ///< those that carry weight, ascending
  std::array<double, 3> weight;  ///< barycentric
  std::size_t n_corners;
  double strength;  ///< λ²
  int part;
  bool patch;
  std::vector<int> rows;

  // What follows belongs to the solve under way.
  Eigen::RowVector2d position;
  Eigen::RowVector2d velocity;  ///< mean of its rows, relative to the rigid field of its part
  Eigen::RowVector2d force;     ///< with which it pulls in the solution of [AKVF 7]
};

/// The point of one handle: vertices, weights and row, of no strength or part.
///
/// \param joined whether two vertices share a triangle
/// \param name of the argument, for errors
///
/// \throw std::invalid_argument it is not inside a triangle, edge or vertex of the mesh
Pin point_of(const Handles& handles, int row, int n_vertices, const std::function<bool(int, int)>& joined,
             const char* name = "handles");

/// The same in a mesh, with its part.
Pin point_of(const Mesh& mesh, const Handles& handles, int row, const char* name = "handles");

/// One pin for each point that has handles, the strongest of them giving its strength. Pins on isolated
/// vertices, which no field moves, are left out.
///
/// \param weights k: λ² of each handle
///
/// \param patch k flags, or empty: none
///
/// \throw std::invalid_argument a handle is not inside a triangle, edge or vertex of the mesh
std::vector<Pin> make_pins(const Mesh& mesh, const Handles& handles, const Eigen::VectorXd& weights,
                           const std::vector<char>& patch);

/// Where a pin is when the mesh's vertices are at x (n×2).
Eigen::RowVector2d pinned_point(const Pin& pin, const Points& x);

}  // namespace planar
