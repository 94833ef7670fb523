// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "mesh/mesh.h"
#include "planar/types.h"

namespace planar {

/// A piece of surface that can be laid flat: connected, without handles, with at least one boundary. What
/// flattening needs to know of it are its triangles, each laid flat by itself; where it is in space does not
/// matter.
struct Patch {
  /// Triangles that lie the other way round than most of the area are turned round.
  ///
  /// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input; a mesh that is no such
  /// patch, with what to do about it
  Patch(const SpacePoints& vertices, const Triangles& triangles);

  /// Corners of a triangle laid flat, counter-clockwise, as numbers of the plane: the first at 0, the second
  /// on the positive real axis.
  using Corners = std::array<std::complex<double>, 3>;

  Mesh mesh;                     ///< its triangles all counter-clockwise as seen from outside
  Flags flat;                    ///< m: triangles that nobody can see (mesh/triangle_shape.h)
  std::vector<Corners> corners;  ///< m
  double area;                   ///< of all triangles

  std::vector<double> length;  ///< of each edge

  /// Boundaries, the longest first: the outer one. The others are holes.
  std::vector<std::vector<int>> loops;

  double area_of(std::size_t t) const { return 0.5 * corners[t][1].real() * corners[t][2].imag(); }
  double length_of(const std::vector<int>& loop) const;

  /// Each triangle laid flat by itself; the patch must outlive it.
  RestOf rest_of() const;

  /// An edge in the middle of the patch: at a vertex from which no other one is far along edges.
  std::array<int, 2> central_edge() const;
};

}  // namespace planar
