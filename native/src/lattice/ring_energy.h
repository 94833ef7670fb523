// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "lattice/lattice_springs.h"
#include "lattice/point_matrix.h"
#include "lattice/weighted_edges.h"

namespace planar {

/// One-rings of vertices of a model, all or a sample: Σ_i m_i Σ_j w_ij |(v'_i - v'_j) - R_i (v_i - v_j)|²
/// [LPFFD 3] with the rotations R_i that make it least.
template <int D>
class RingEnergy {
 public:
  /// The rings of all vertices.
  RingEnergy(const Rows<D>& rest, const LatticeWeights& weights, const WeightedEdges& edges);
  /// Of these alone, each counted as often as `multiple` says.
  RingEnergy(const Rows<D>& rest, const LatticeWeights& weights, const WeightedEdges& edges,
             const std::vector<int>& centres, Eigen::VectorXd multiple);

  /// What each vertex's ring weighs: Σ_j w_ij |v_i - v_j|².
  static Eigen::VectorXd measures(const Rows<D>& rest, const WeightedEdges& edges);

  /// Adds half the Hessian of `factor` times the energy by d, the rotations held: Σ w (W_i - W_j)ᵀ (W_i -
  /// W_j).
  void add_squares(PointMatrix& matrix, double factor) const;

  /// Fits the rotations to the shape at d. The energy; minus half its derivatives by d, the rotations held,
  /// are added to `force` (N×D) if there is one.
  double value(const Rows<D>& d, Rows<D>* force);

  /// The rigid motion of the rest nearest to the shape at the last value(); each centre counts as its
  /// multiple.
  Motion<D> motion() const;

 private:
  struct Edge {
    int to;
    double weight;
  };

  LatticeWeights weights_;  ///< rows of the vertices here
  Rows<D> rest_;
  std::vector<std::size_t> start_{0};  ///< of the edges of a ring
  std::vector<Edge> edges_;            ///< from the ring's centre
  std::vector<int> centre_;
  Eigen::VectorXd multiple_;
  Rows<D> u_, vertex_force_;
};

}  // namespace planar
