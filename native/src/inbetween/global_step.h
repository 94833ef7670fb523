// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "inbetween/frame_assembler.h"
#include "mesh/edge_graph.h"
#include "parallel/thread_team.h"

namespace planar {

/// [AIAP 6] for all inner frames at once, with c by [AIAP 8] of the edges as they are: A x = b with
///
///   A = Σ (d dᵀ) ⊗ M,  b = Σ d ⊗ r,  over the edges,
///
/// d = -1 and 1 at an edge's ends, M and r the edge's equations of [AIAP 9], a row and column a frame.
/// Unknowns may be shifted frame by frame. By conjugate gradients with P = Σ (d dᵀ) ⊗ M̄ in place of A, where
/// M̄ is the mean of the edges' M in a part: one factor for the shape and one for time. P is A where a part
/// turns as a whole; where it bends by θ, eigenvalues of P⁻¹A lie between some 1/(1 + 2θ²/π²) and 2, so that
/// some twenty steps do. A sparse factor of A itself fills in like that of a mesh in space: it took 90 s at
/// 1900 vertices.
class GlobalStep {
 public:
  GlobalStep(const EdgeGraph& graph, ThreadTeam& team);

  /// From the inner frames of `points` as they are to the solution.
  /// \param progress called with the share of the work done, many times a step; may throw
  /// \throw SolveError the steps do not get there
  void assemble(const ComplexRows& edges, ComplexRows& points, const std::function<void(double)>& progress);

 private:
  using Tell = std::function<void()>;
  void run(const Tell& tell, Eigen::Index count, const std::function<void(Eigen::Index)>& task);
  void set_equations(const ComplexRows& edges, const Tell& tell);
  void multiply(const ComplexRows& x, ComplexRows& image, const Tell& tell);
  void precondition(const ComplexRows& r, ComplexRows& z, const Tell& tell);

  const EdgeGraph& graph_;
  ThreadTeam& team_;
  FrameAssembler space_;
  Eigen::Index inner_ = 0;  ///< frames
  Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> diagonal_;
  ComplexRows below_, right_;  ///< of edges
  Eigen::ArrayXXd part_diagonal_;
  ComplexRows part_below_;
};

}  // namespace planar
