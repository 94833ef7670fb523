// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "flatten/laplacian.h"
#include "flatten/patch.h"
#include "linear/sparse_solver.h"
#include "linear/unknowns.h"
#include "posing/edge_neighbourhood.h"

namespace planar {

/// Flattening in two steps [ARAP09, section 7]: the map in which each edge and its one or two triangles, laid
/// flat, are most nearly similar to what they are, then the one in which edges have their length and the
/// direction found. The two ends of an edge are fixed: the first at 0, the other as far as on the surface
/// along the positive x axis. What can be unrolled is, exactly.
class TwoSteps {
 public:
  /// \param weight of each edge of the patch's mesh
  /// \param fixed two vertices that share an edge
  /// \throw SolveError a system could not be factored
  TwoSteps(const Patch& patch, const Eigen::VectorXd& weight, std::array<int, 2> fixed);

  /// The first step [ARAP09 5]: n×2, vertices of no triangle at 0.
  Points similar() const;
  /// The second step [ARAP09 7] with each edge's turn taken from x. It may be repeated from its own result.
  Points adjusted(const Points& x) const;

 private:
  void factor_similar(const std::vector<char>& free);

  Points fixed_;  ///< n×2: the fixed ends where they stay, 0 elsewhere
  std::vector<EdgeNeighbourhood> edges_;
  Eigen::VectorXd weight_;  ///< of each
  std::unique_ptr<HermitianSolver> similar_;
  std::unique_ptr<Unknowns> unknowns_;  ///< of the first step
  Eigen::VectorXcd right_;
  std::unique_ptr<Laplacian> adjusted_;
};

}  // namespace planar
