// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>
#include <vector>

#include "planar/lattice.h"
#include "support.h"

namespace planar::testing {

inline const std::vector<LatticeBasis> all_bases{LatticeBasis::bernstein, LatticeBasis::linear,
                                                 LatticeBasis::cardinal, LatticeBasis::catmull_rom,
                                                 LatticeBasis::bspline};

/// A grid round points, with `margin` whole free cells on each side.
LatticeGrid grid_round(const Coordinates& points, const std::vector<int>& count, LatticeBasis basis,
                       int margin);

Coordinates points_of(const LatticeGrid& grid);

/// A mesh in a lattice.
struct InLattice {
  InLattice(const Shape& shape_, const std::vector<int>& count, LatticeBasis basis = LatticeBasis::bspline,
            int margin = 1)
      : shape(shape_),
        lattice(grid_round(shape.vertices, count, basis, margin)),
        lattice_rest(points_of(lattice)),
        weights(lattice_weights(shape.vertices, lattice)) {}

  LatticeSolver solver(const LatticeOptions& options = {}) const {
    return {shape.vertices, shape.triangles, weights, lattice_rest, options};
  }
  LatticeHandles handles(const std::vector<int>& vertices) const { return {at(shape, vertices), {}, {}, {}}; }
  Points rest(const std::vector<int>& vertices) const { return shape.vertices(vertices, Eigen::all); }
  double diagonal() const {
    return (shape.vertices.colwise().maxCoeff() - shape.vertices.colwise().minCoeff()).norm();
  }

  Shape shape;
  LatticeGrid lattice;
  Coordinates lattice_rest;
  LatticeWeights weights;
};

inline const Coordinates no_targets;

/// A bar of about as many vertices along and across as said.
Shape bar(int along, int across, double length = 4.0);

Coordinates random_coordinates(Eigen::Index n, Eigen::Index columns, unsigned seed);

}  // namespace planar::testing
