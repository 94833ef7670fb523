// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "flatten/laplacian.h"
#include "flatten/patch.h"
#include "linear/sparse_solver.h"

namespace planar {

/// Flattening in two steps [ARAP09, section 7]: the map in which each edge and its one or two triangles, laid
/// flat, are most nearly similar to what they are, then the one in which edges have their length and the
/// direction found. The two ends of an edge are fixed: the first at 0, the other as far as on the surface
/// along the positive x axis. What can be unrolled is, exactly.
class TwoSteps {
 public:
  /// \param patch must outlive this
  /// \param weight of each edge of the patch's mesh
  /// \param fixed two vertices that share an edge
  /// \throw SolveError a system could not be factored
  TwoSteps(const Patch& patch, const Eigen::VectorXd& weight, std::array<int, 2> fixed);

  /// The first step [ARAP09 5]: n×2, vertices of no triangle at 0.
  Points similar() const;
  /// The second step [ARAP09 7] with each edge's turn taken from x. It may be repeated from its own result.
  Points adjusted(const Points& x) const;

 private:
  /// An edge's neighbourhood laid flat: its ends at 0 and on the positive real axis, and its apexes.
  struct Neighbourhood {
    std::array<int, 4> vertex;
    std::array<std::complex<double>, 4> fit;  ///< T = Σ fit x is the similarity nearest to x [ARAP09 6]
    std::size_t size;                         ///< vertices: 3 or 4
    double length;                            ///< of the edge
    double weight;
  };
  Neighbourhood neighbourhood(std::size_t edge, double weight) const;
  static std::complex<double> similarity(const Neighbourhood& edge, const Points& x);

  void factor_similar(const std::vector<char>& free);

  const Patch& patch_;
  Points fixed_;  ///< n×2: the fixed ends where they stay, 0 elsewhere
  std::vector<Neighbourhood> edges_;
  std::unique_ptr<HermitianSolver> similar_;
  std::unique_ptr<Unknowns> unknowns_;  ///< of the first step
  Eigen::VectorXcd right_;
  std::unique_ptr<Laplacian> adjusted_;
};

}  // namespace planar
