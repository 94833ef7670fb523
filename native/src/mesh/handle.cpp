// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/handle.h"

#include <cmath>

#include "base/checks.h"

namespace planar {

namespace {

constexpr double barycentric_tolerance = 1e-6;

}  // namespace

Handles Handles::at_vertices(const Eigen::VectorXi& vertex, Eigen::Index n_vertices) {
  Handles handles;
  handles.vertices = vertex.replicate(1, 3);
  handles.weights.setZero(vertex.size(), 3);
  handles.weights.col(0).setOnes();
  for (Eigen::Index i = 0; i < vertex.size(); ++i) {
    require_index("handles", i, "vertex", vertex[i], n_vertices);
  }
  return handles;
}

Handles Handles::in_triangles(const Eigen::VectorXi& triangle,
                              const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& barycentric,
                              const Triangles& triangles, Eigen::Index n_vertices) {
  require_rows("barycentric", barycentric.rows(), triangle.size(), "handle");
  Handles handles;
  handles.vertices.resize(triangle.size(), 3);
  handles.weights.resize(triangle.size(), 3);
  for (Eigen::Index i = 0; i < triangle.size(); ++i) {
    require_index("handles", i, "triangle", triangle[i], triangles.rows());
    handles.vertices.row(i) = triangles.row(triangle[i]);
    for (int c = 0; c < 3; ++c)
      require_index("triangles", triangle[i], "vertex", handles.vertices(i, c), n_vertices);
    const auto weights = barycentric.row(i);
    // Written so that a NaN fails too.
    if (!(weights.minCoeff() >= -barycentric_tolerance &&
          std::abs(weights.sum() - 1.0) <= barycentric_tolerance)) {
      throw std::invalid_argument(row_of("barycentric", i) +
                                  "must be three numbers from 0 to 1 that sum to 1");
    }
    handles.weights.row(i) = weights / weights.sum();
  }
  return handles;
}

Points Handles::positions(const Points& x) const {
  Points result(size(), 2);
  for (Eigen::Index i = 0; i < size(); ++i) {
    result.row(i) = weights(i, 0) * x.row(vertices(i, 0)) + weights(i, 1) * x.row(vertices(i, 1)) +
                    weights(i, 2) * x.row(vertices(i, 2));
  }
  return result;
}

}  // namespace planar
