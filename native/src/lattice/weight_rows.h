// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "planar/lattice.h"

namespace planar {

/// Positions or displacements in D dimensions.
template <int D>
using Rows = Eigen::Matrix<double, Eigen::Dynamic, D, Eigen::RowMajor>;

/// u = W d.
template <int D>
void product(const LatticeWeights& weights, const Rows<D>& d, Rows<D>& u);

/// r += Wᵀ g. Rows of g that are 0 cost next to nothing.
template <int D>
void add_transposed(const LatticeWeights& weights, const Rows<D>& g, Rows<D>& r);

/// W of compressed rows: row i has the values from start[i] on, at these columns, which ascend in each row.
LatticeWeights of_rows(Eigen::Index columns, const std::vector<int>& start, const std::vector<int>& column,
                       const std::vector<double>& value);

/// Rows of W, in this order.
LatticeWeights chosen_rows(const LatticeWeights& weights, const std::vector<int>& chosen);

/// The vertices with the same points, of which there are about as many kinds as cells.
struct Supports {
  std::vector<std::vector<int>> points;  ///< of a kind, ascending
  std::vector<int> kind;                 ///< of a vertex
};
Supports supports_of(const LatticeWeights& weights);

/// The pairs of lattice points, each once, that move one vertex, or the two ends of one edge: where JᵀJ of
/// anything over these edges has entries.
/// \throw SolveError more than 5e7
std::vector<std::array<int, 2>> couplings(const LatticeWeights& weights,
                                          const std::vector<std::array<int, 2>>& edges);

/// A linear combination of rows of W: what it makes of the points that any of them has, in ascending order.
/// Made once and used for many, so that nothing is allocated.
class RowSum {
 public:
  explicit RowSum(const LatticeWeights& weights) : weights_(weights), place_(weights.cols(), -1) {}

  /// Begins a sum of `width` values a point.
  void clear(int width);
  /// Adds factor[k] W_row to the values k of each point.
  template <std::size_t Width>
  void add(int row, const std::array<double, Width>& factor);

  int size() const { return static_cast<int>(point_.size()); }
  const std::vector<int>& points() const { return point_; }
  double value(int i, int k) const {
    const int place = i * width_ + k;
    return value_[static_cast<std::size_t>(place)];
  }

 private:
  const LatticeWeights& weights_;
  std::vector<int> place_, point_;
  std::vector<double> value_;
  int width_ = 1;
};

template <std::size_t Width>
void RowSum::add(int row, const std::array<double, Width>& factor) {
  const int* start = weights_.outerIndexPtr();
  for (int e = start[row]; e < start[row + 1]; ++e) {
    const int point = weights_.innerIndexPtr()[e];
    int& place = place_[static_cast<std::size_t>(point)];
    if (place < 0) {
      place = size();
      point_.push_back(point);
      value_.insert(value_.end(), Width, 0.0);
    }
    for (std::size_t k = 0; k < Width; ++k) {
      value_[static_cast<std::size_t>(place) * Width + k] += factor[k] * weights_.valuePtr()[e];
    }
  }
}

}  // namespace planar
