// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "lattice/held_samples.h"
#include "lattice/lattice_frame.h"
#include "lattice/lattice_springs.h"
#include "lattice/point_matrix.h"
#include "lattice/sub_cells.h"

namespace planar {

/// The linear systems of "hold": the positive Hessian of its energy in the points of the lattice. That of
/// the triangles is summed over sub-cells, a quarter of a cell wide, and applied at the rows of one triangle
/// of each; triangles that are near collapse, whose Hessian differs from their neighbours', are taken each at
/// its own.
class HeldSystem {
 public:
  /// \param weights, shape must outlive this
  /// \param cells of the shape's triangles
  /// \param smooth what the squares of `differences` count
  HeldSystem(const LatticeWeights& weights, const HeldShape& shape, SubCells cells,
             std::vector<Difference> differences, double smooth);

  /// Adds what stays: springs and smoothing.
  void compile(const LatticeSprings<2>& springs);

  /// Σ smooth |difference|²; its derivatives are added to `gradient` if there is one.
  double smoothness(const Points& d, Points* gradient) const;

  /// Factors the Hessian with `shape_weight` times that of the triangles, at u.
  /// \throw SolveError
  void factorize(const Points& u, double shape_weight);
  /// The same from samples, at d.
  void factorize(const HeldSamples& samples, const Points& d, double shape_weight);
  /// Newton's step for a gradient; locked points stay.
  void solve(const Points& gradient, Points& step);

 private:
  using Form = std::array<std::array<double, 4>, 4>;
  /// The points that move a triangle, in the order of the matrix, with their gradients.
  struct Place {
    PointMatrix::Block block;
    std::vector<std::array<double, 2>> gradient;
  };

  Place place_of(const HeldShape::Triangle& triangle);
  void add(int triangle, const Jacobian& j, double weight);
  void finish();

  const HeldShape& shape_;
  SubCells cells_;
  std::vector<Difference> differences_;
  double smooth_;
  double near_collapse_;
  PointMatrix matrix_;
  RowSum sum_;
  std::vector<Place> place_;     ///< of a sub-cell
  std::vector<Form> form_;       ///< of a sub-cell
  std::vector<double> staying_;  ///< values of the matrix that do not depend on the state
  std::vector<char> locked_;
  RightSides side_;
};

}  // namespace planar
