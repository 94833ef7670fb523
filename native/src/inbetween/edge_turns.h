// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/edge_graph.h"

namespace planar {

/// By how much each edge turns between two keys, whole turns included: neighbours turn alike.
///
/// In a mesh angles are unwrapped on triangles, not on edges as the paper does: the rotation of a triangle's
/// polar decomposition is less noisy than that of an edge, which stretching turns too. They are propagated
/// smallest difference first, not breadth first, so that a difference near half a turn decides nothing where
/// there is a way around it. An edge turns by the mean of its triangles plus what is left, between -π and π.
/// Shapes without triangles propagate from edge to edge at common vertices.
///
/// Last, the whole turns of each part are left out: the median of what is propagated lies between -π and π.
class EdgeTurns {
 public:
  explicit EdgeTurns(const EdgeGraph& graph);

  /// Radians, one an edge. Keys exchanged give the turns negated.
  Eigen::VectorXd between(const Points& from, const Points& to) const;

 private:
  struct Link {
    int a, b;
  };

  Eigen::VectorXd of_triangles(const Points& from, const Points& to) const;
  std::vector<Link> links_at_vertices(const Eigen::VectorXd& angles) const;

  const EdgeGraph& graph_;
  std::vector<std::vector<Link>> links_;  ///< of triangles: across sides, then across lone vertices
  std::vector<int> edge_triangle_;        ///< the triangles at an edge, one edge after another
  std::vector<std::size_t> first_edge_triangle_;
  std::vector<int> node_part_;    ///< of what is propagated: triangles, or edges
  std::vector<int> vertex_edge_;  ///< without triangles: the edges at a vertex
  std::vector<std::size_t> first_vertex_edge_;
};

/// The rotation of the polar decomposition of a triangle's Jacobian, times a positive number, from two of its
/// sides s1 and s2 and what they become. Of a triangle that is turned over, or flat in one of the two shapes,
/// the one that takes its sides nearest to what they become: so that the way back is the reverse, which that
/// of the decomposition would not be.
std::complex<double> triangle_turn(std::complex<double> s1, std::complex<double> s2, std::complex<double> d1,
                                   std::complex<double> d2);

/// The angle between -π and π that differs from it by whole turns.
double wrapped(double angle);

}  // namespace planar
