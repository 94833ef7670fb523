// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "linear/sparse_solver.h"
#include "mesh/edge_graph.h"

namespace planar {

/// Places vertices by wanted edge vectors, [AIAP 10]: minimises Σ w |p_b - p_a - e|². The first
/// vertex of each part and isolated vertices lie at 0.
class FrameAssembler {
 public:
  /// Frames that are solved in one pass; tables of frames have a multiple of it as columns.
  static constexpr Eigen::Index lanes = 4;
  static Eigen::Index padded(Eigen::Index frames) { return (frames + lanes - 1) / lanes * lanes; }

  explicit FrameAssembler(const EdgeGraph& graph);

  /// \param weights w, one an edge, above 0
  /// \throw SolveError a singular system
  void factorize(const Eigen::VectorXd& weights);

  /// Fills in the points of frames first..first+lanes-1 from the same columns of `edges`. May be called in
  /// several threads at once; what a frame becomes does not depend on its neighbours.
  void assemble(const ComplexRows& edges, Eigen::Index first, ComplexRows& points) const;

  /// The same for one frame of one column.
  void assemble_one(const ComplexRows& edges, ComplexRows& points) const;

  /// The same with Σ w e given, over the edges that end at a vertex, less those that begin there: it is in
  /// `points`, and adds up to 0 in each part.
  void assemble_sums(Eigen::Index first, ComplexRows& points) const;

 private:
  template <Eigen::Index width>
  void solve(const ComplexRows& edges, Eigen::Index first, ComplexRows& points) const;
  template <Eigen::Index width>
  void place_points(const RightSides& x, Eigen::Index first, ComplexRows& points) const;

  const EdgeGraph& graph_;
  Eigen::VectorXd weights_;
  std::unique_ptr<SparseSolver> solver_;
  std::vector<int> slot_;  ///< of a vertex in the order of the unknowns
  SymmetricMatrix matrix_;
  std::vector<int> entry_;     ///< of an edge among the values of matrix_
  std::vector<int> diagonal_;  ///< of a vertex
  std::vector<int> pinned_;    ///< the first vertex of each part, and isolated ones
};

}  // namespace planar
