// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "base/complex_product.h"
#include "mesh/mesh.h"
#include "planar/arap.h"

namespace planar {

/// An edge, its triangles laid flat beside it, and the similarity that fits them best to where their corners
/// are: N(e) and T of [ARAP09 3]. Points are numbers of the plane, in which T is a factor.
///
/// Departures: T maps differences from the mean of N(e). As printed it maps the points themselves, and
/// depends on where the origin is. Of an edge with more than two triangles the first two count.
struct EdgeNeighbourhood {
  std::array<int, 4> vertex;  ///< the edge's own, the smaller first, then the other corners
  std::size_t n_vertices;     ///< 3 or 4
  std::complex<double> edge;  ///< at rest
  /// Σ fit v' is T edge [ARAP09 6]. Sums to 0.
  std::array<std::complex<double>, 4> fit;

  /// T edge where the vertices are at `x`.
  std::complex<double> fitted(const std::complex<double>* x) const {
    std::complex<double> sum = 0.0;
    for (std::size_t m = 0; m < n_vertices; ++m)
      sum += product(fit[m], x[static_cast<std::size_t>(vertex[m])]);
    return sum;
  }

  /// Of `vertex`: what is left of the edge, x[1] - x[0] - T edge, is Σ left x.
  std::array<std::complex<double>, 4> left() const {
    std::array<std::complex<double>, 4> result{-1.0, 1.0, 0.0, 0.0};
    for (std::size_t m = 0; m < n_vertices; ++m) result[m] -= fit[m];
    return result;
  }
};

/// Those of a mesh's edges, in their order, then one for each brace: the missing side, with the vertex.
///
/// \param rest_of with t = -1 for the corners of braces
std::vector<EdgeNeighbourhood> edge_neighbourhoods(const Mesh& mesh, const RestOf& rest_of);

/// Pairs of vertices that are in one neighbourhood: those between which the first step has entries.
std::vector<std::array<int, 2>> couplings(const std::vector<EdgeNeighbourhood>& hoods);

/// The weights of a mesh's edges, see cotangent_weights.h.
/// \param stiffness m factors, or empty
Eigen::VectorXd edge_weights(const Mesh& mesh, const RestOf& rest_of, ArapWeights weights,
                             const Eigen::VectorXd& stiffness = {});

}  // namespace planar
