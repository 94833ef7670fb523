// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "mesh/edge_graph.h"

/// What changes of a whole sequence of frames have in common.
namespace planar {

/// Of the size of the shapes: edges that are shorter have no direction in numbers rounded to float32.
constexpr double no_length = 1e-7;

/// \throw std::invalid_argument no frames, or frames of several sizes or with numbers that are not finite
void require_frames(const std::vector<Points>& frames);

/// The means of the parts' vertices; isolated vertices are parts of their own, behind the others.
class Centroids {
 public:
  explicit Centroids(const EdgeGraph& graph)
      : group_(graph.part), count_(static_cast<std::size_t>(graph.n_parts)) {
    for (int& group : group_) {
      if (group == -1) {
        group = static_cast<int>(count_.size());
        count_.push_back(0.0);
      }
      count_[static_cast<std::size_t>(group)] += 1.0;
    }
  }

  /// Of the vertices at place_of(vertex).
  std::vector<std::complex<double>> of(const auto& place_of) const {
    std::vector<std::complex<double>> sum(count_.size());
    for (std::size_t v = 0; v < group_.size(); ++v) {
      sum[static_cast<std::size_t>(group_[v])] += place_of(static_cast<Eigen::Index>(v));
    }
    for (std::size_t group = 0; group < sum.size(); ++group) sum[group] /= count_[group];
    return sum;
  }

  std::vector<std::complex<double>> of(const Points& x) const {
    return of([&x](Eigen::Index v) { return std::complex<double>(x(v, 0), x(v, 1)); });
  }

  std::size_t group(Eigen::Index v) const {
    return static_cast<std::size_t>(group_[static_cast<std::size_t>(v)]);
  }

 private:
  std::vector<int> group_;
  std::vector<double> count_;
};

/// Frames assembled from edge vectors, [AIAP 10] with weights frozen at `references`.
///
/// \param edges_of fills a column with the edge vectors of a frame; called in several threads
///
/// \param centres_of the Centroids of a frame
///
/// \throw SolveError the frames cannot be assembled, or overflow
std::vector<Points> assembled(
    const EdgeGraph& graph, const std::vector<Points>& references, std::size_t n_frames,
    const std::function<void(std::size_t frame, ComplexRows& edges, Eigen::Index column)>& edges_of,
    const std::function<std::vector<std::complex<double>>(std::size_t frame)>& centres_of);

}  // namespace planar
