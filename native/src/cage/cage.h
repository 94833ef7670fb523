// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/complex_rows.h"
#include "cage/carried_mesh.h"
#include "linear/sparse_solver.h"
#include "linear/unknowns.h"
#include "mesh/mesh.h"
#include "planar/handle.h"
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
  Points rest;                          ///< c×2; the last ones are the isolated vertices of the dense mesh
  Triangles triangles;                  ///< counter-clockwise
  std::vector<Place> places;            ///< n: of the dense vertices; isolated ones are in no triangle
  std::vector<int> isolated;            ///< dense vertices
  std::vector<Coarse::Origin> origins;  ///< c

  /// The row of the cage that is an isolated dense vertex.
  int row_of(int isolated_vertex) const;
};

/// A coarse mesh of about `wished` vertices for a dense one, see coarsened(); more where the mesh has parts,
/// or fixed vertices, that ask for them. None for a mesh of no more than `wished` vertices, or one that this
/// would leave with more than half of them.
/// \throw Cancelled progress returned false
std::optional<Coarse> coarse_for_cage(const Points& rest, const Triangles& triangles, int wished,
                                      const std::function<bool(double)>& progress = {});

Cage make_cage(const Points& rest, Coarse coarse);

/// The place in a triangle of the mesh, seen at `rest`, of a point.
Place place_in(const Points& rest, const Triangles& triangles, int triangle, const Eigen::RowVector2d& point);

/// Points of the dense mesh, seen at `rest`, as points of the cage: each in that of its corners' triangles
/// which holds it best.
/// \pre handles name points of the dense mesh
Handles caged(const Handles& handles, const Cage& cage, const Points& rest);

/// Where a place is when the mesh's vertices are at x. \pre it is in a triangle
inline Eigen::RowVector2d carried(const Place& place, const Triangles& triangles, const Points& x) {
  const int* corner = triangles.data() + 3 * place.triangle;
  const double *a = x.data() + 2 * corner[0], *b = x.data() + 2 * corner[1], *c = x.data() + 2 * corner[2];
  return {a[0] + place.first * (b[0] - a[0]) + place.second * (c[0] - a[0]),
          a[1] + place.first * (b[1] - a[1]) + place.second * (c[1] - a[1])};
}

/// Which triangles of the dense mesh can be turned over although the cage's are not.
class Suspects {
 public:
  /// \param rest n×2
  Suspects(const Cage& cage, const Points& rest, const Triangles& triangles);

  /// Rows of the dense triangles that lie in several of the cage's, and of those in one of the cage's that is
  /// turned over or squeezed to little area at x; all rows if `all`. Float32 tells the others from turned
  /// ones.
  std::vector<int> at(const Cage& cage, const Points& x, bool all) const;

 private:
  std::vector<int> across_;          ///< rows
  std::vector<int> first_, inside_;  ///< rows in each triangle of the cage, one list after the other
  bool far_;                         ///< from the origin, so that float32 tells less
};

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

/// The positions of a cage whose vertices are where the dense mesh is that they were made from, a little
/// beside them as the mesh is deformed there. Unlike a fit it turns hardly a triangle over that the mesh does
/// not, however fine the cage is.
class CageSample {
 public:
  /// \param rest n×2
  CageSample(const Cage& cage, const Points& rest, const Triangles& triangles);

  /// \param x n×2
  /// \return c×2
  Points at(const Cage& cage, const Points& x) const;

 private:
  /// A dense triangle with a vertex that the cage's vertex `row` was made from.
  struct Fan {
    int row;
    std::array<int, 3> corner;
    std::complex<double> first, second;  ///< sides at rest
    double area;                         ///< twice that at rest, signed
  };

  std::vector<Fan> fans_;
  std::vector<std::complex<double>> beside_;  ///< c: from where a vertex was made to where it is at rest
};

/// What a cage leaves of a shape of the dense mesh, turned with the cage's triangles from where they were
/// then.
class Remainder {
 public:
  /// Nothing.
  Remainder() = default;

  /// \param fitted c×2: the cage
  /// \param x n×2
  /// \param negligible length up to which it is nothing
  Remainder(const Cage& cage, const Points& fitted, const Points& x, double negligible);

  bool is_empty() const { return left_.rows() == 0; }
  double largest() const { return largest_; }

  using Turns = std::vector<std::complex<double>>;
  /// The turns of the cage's triangles to where they are at x; empty if there is nothing to turn.
  Turns turns_to(const Cage& cage, const Points& x) const;
  /// Of a dense vertex that is not isolated. \pre turns is not empty
  Eigen::RowVector2d of(const Cage& cage, Eigen::Index v, const Turns& turns) const {
    const std::complex<double> p =
        turns[static_cast<std::size_t>(cage.places[static_cast<std::size_t>(v)].triangle)] *
        complex_row(left_, v);
    return {p.real(), p.imag()};
  }

 private:
  Points left_{0, 2};  ///< n
  Points fitted_;
  double largest_ = 0.0;
};

}  // namespace planar
