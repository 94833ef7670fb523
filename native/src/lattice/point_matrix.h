// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "linear/sparse_solver.h"

namespace planar {

/// A symmetric positive definite matrix over the points of a lattice, with one unknown a point or two (x and
/// y). Its pattern, which is all that an analysis needs, stays.
class PointMatrix {
 public:
  /// Points in the order of their unknowns, with the places of their blocks. Looked up once, it makes adding
  /// cheap.
  struct Block {
    std::vector<int> place;  ///< of the points, ascending
    std::vector<int> entry;  ///< of the pairs (earlier, later or same): later's number in earlier's column
  };

  /// \param coupled pairs of points with entries
  /// \throw SolveError no memory
  PointMatrix(int n_points, const std::vector<std::array<int, 2>>& coupled, int unknowns);

  int place(int point) const { return place_[static_cast<std::size_t>(point)]; }

  /// \param place of points each two of which are coupled, ascending
  Block block(std::vector<int> place) const;

  void set_zero();
  /// One unknown a point: adds a symmetric matrix over the block, its upper triangle by rows.
  void add(const Block& block, const double* value);
  /// Adds weight · row rowᵀ, a value for each of some points, for each unknown of a point by itself.
  void add_square(const std::vector<int>& points, const double* row, double weight);
  /// Two: adds GᵀHG, where G d = (Σ gx_p x_p, Σ gy_p x_p, Σ gx_p y_p, Σ gy_p y_p), gradient = gx_p, gy_p for
  /// each place of the block. H is symmetric.
  void add_form(const Block& block, const std::array<double, 2>* gradient,
                const std::array<std::array<double, 4>, 4>& form);
  void add_to_diagonal(double value);
  /// Mean of the diagonal.
  double scale() const;
  /// Takes the points that are `fixed` (a flag a point) out: unit rows, and nothing of them in others.
  void fix(const std::vector<char>& fixed);

  /// \throw SolveError not positive definite, or no memory
  void factorize();
  /// x ← A⁻¹ x; a row a point. `values` a column each, or, with two unknowns, x and y.
  void solve(RightSides& x);

  /// To be kept, and given back instead of set_zero().
  const std::vector<double>& values() const { return matrix_.value; }
  void set_values(const std::vector<double>& values) { matrix_.value = values; }

 private:
  std::size_t column(int place, int axis) const {
    const int unknown = unknowns_ * place + axis;
    return static_cast<std::size_t>(matrix_.column_start[static_cast<std::size_t>(unknown)]);
  }

  int unknowns_;
  std::vector<int> place_, point_;
  SparsityPattern pattern_;  ///< of the points, by place
  SymmetricMatrix matrix_;
  std::unique_ptr<SparseSolver> solver_;
  RightSides sides_;
  Eigen::VectorXd unknown_;
};

}  // namespace planar
