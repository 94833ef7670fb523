// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planar/types.h"

namespace planar {

/// k points of a mesh, each the weighted mean of the three vertices of its row. The weights of a row sum
/// to 1. A vertex v is (v, v, v) with weights (1, 0, 0). The vertices that carry weight in a row, more than
/// 1e-9, must be those of one triangle (or edge, or vertex).
struct Handles {
  Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor> vertices;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights;

  /// Handles at k vertices of a mesh with n_vertices vertices.
  /// \throw std::invalid_argument naming the row whose vertex is out of range
  static Handles at_vertices(const Eigen::VectorXi& vertex, Eigen::Index n_vertices);

  /// Handles inside k triangles (k row numbers of `triangles`) at k×3 barycentric weights: not below 0 and
  /// summing to 1, both within 1e-6 (float32 input); the sum is then made exact.
  ///
  /// \throw std::invalid_argument naming the row at fault
  static Handles in_triangles(const Eigen::VectorXi& triangle,
                              const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& barycentric,
                              const Triangles& triangles, Eigen::Index n_vertices);

  /// k
  Eigen::Index size() const { return vertices.rows(); }

  /// k×2: where the handles are when the mesh's vertices are at x (n×2).
  /// \pre every index of `vertices` is a row of x
  Points positions(const Points& x) const;
};

}  // namespace planar
