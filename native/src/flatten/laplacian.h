// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "linear/sparse_solver.h"
#include "linear/unknowns.h"
#include "planar/types.h"

namespace planar {

/// The Laplacian of a weighted graph, of which some vertices stay where they are.
class Laplacian {
 public:
  /// \param weight above 0, of each edge
  /// \param free a flag a vertex, of whose part at least one vertex is not free
  /// \throw SolveError it could not be factored
  Laplacian(const std::vector<std::array<int, 2>>& edges, const Eigen::VectorXd& weight,
            const std::vector<char>& free);

  /// Moves the free vertices in x (n×2) to where Σ weight (x_v - x_u) = force (n×2) over the edges of each.
  void solve(const Points& force, Points& x) const;

 private:
  struct Neighbour {
    int slot, fixed;  ///< the unknown and the vertex that stays, which an edge joins
    double weight;
  };
  std::unique_ptr<SparseSolver> solver_;
  Unknowns unknowns_;
  std::vector<Neighbour> neighbours_;
};

}  // namespace planar
