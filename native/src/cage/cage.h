// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cage/carried_mesh.h"
#include "linear/sparse_solver.h"
#include "linear/unknowns.h"
#include "mesh/mesh.h"
#include "planar/types.h"

namespace planar {

/// Where points are in the triangles of a mesh: corner 0 plus `first` times the way to corner 1 plus `second`
/// times that to corner 2. Points outside of their triangle go with its affine map.
struct Place {
  int triangle;  ///< -1: in none
  double first, second;
};

/// A coarse mesh round a dense one, to be posed in its stead.
struct Cage {
  Points rest;                ///< c×2
  Triangles triangles;        ///< counter-clockwise
  std::vector<Place> places;  ///< n: of the dense vertices; in no triangle are those that are in no dense one
  std::vector<Coarse::Origin> origins;  ///< c
};

/// A coarse mesh of about `wished` vertices for a dense one, see coarsened(); more where the mesh has parts,
/// or fixed vertices, that ask for them. None for a mesh of no more than `wished` vertices, or one that this
/// would leave with more than half of them.
std::optional<Coarse> coarse_for_cage(const Points& rest, const Triangles& triangles, int wished);

/// If there are isolated vertices, the last vertex of the cage is one.
Cage make_cage(const Points& rest, Coarse coarse);

/// The place in a triangle of the mesh, seen at `rest`, of a point.
Place place_in(const Points& rest, const Triangles& triangles, int triangle, const Eigen::RowVector2d& point);

/// Where a place is when the mesh's vertices are at x. \pre it is in a triangle
inline Eigen::RowVector2d carried(const Place& place, const Triangles& triangles, const Points& x) {
  const int* corner = triangles.data() + 3 * place.triangle;
  const double *a = x.data() + 2 * corner[0], *b = x.data() + 2 * corner[1], *c = x.data() + 2 * corner[2];
  return {a[0] + place.first * (b[0] - a[0]) + place.second * (c[0] - a[0]),
          a[1] + place.first * (b[1] - a[1]) + place.second * (c[1] - a[1])};
}

/// The positions of a cage whose carried vertices are nearest to given ones, by least squares; factored once.
class CageFit {
 public:
  /// \param mesh of the cage; both must outlive this
  CageFit(const Cage& cage, const Mesh& mesh);

  /// \param x n×2
  /// \return c×2
  Points fit(const Points& x) const;

 private:
  const Cage& cage_;
  std::unique_ptr<SparseSolver> solver_;
  Unknowns unknowns_;  ///< all vertices
};

}  // namespace planar
