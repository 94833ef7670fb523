// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/checks.h"

#include <cmath>

namespace planar {

void require_cage(const std::optional<int>& cage) {
  constexpr int fewest = 12;
  if (cage && *cage < fewest) {
    throw std::invalid_argument("cage: " + std::to_string(*cage) + " vertices, expected " +
                                std::to_string(fewest) + " at least");
  }
}

std::string row_of(const char* name, Eigen::Index row) {
  return std::string(name) + ", row " + std::to_string(row) + ": ";
}

void require_index(const char* name, Eigen::Index row, const char* kind, Eigen::Index index,
                   Eigen::Index count) {
  if (index >= 0 && index < count) return;
  throw std::invalid_argument(row_of(name, row) + kind + " " + std::to_string(index) +
                              " is out of range, there are " + std::to_string(count));
}

void require_rows(const char* name, Eigen::Index rows, Eigen::Index expected, const char* of) {
  if (rows != expected) {
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(rows) + " rows, expected " +
                                std::to_string(expected) + " (one per " + of + ")");
  }
}

void require_finite(const char* name, const Eigen::Ref<const Points>& values) {
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    if (!std::isfinite(values(i, 0)) || !std::isfinite(values(i, 1))) {
      throw std::invalid_argument(row_of(name, i) + "not a finite number");
    }
  }
}

void require_finite_rows(
    const char* name, const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& values) {
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    if (!values.row(i).allFinite()) throw std::invalid_argument(row_of(name, i) + "not a finite number");
  }
}

void require_float32(const char* name, const Eigen::Ref<const Points>& values) {
  require_finite(name, values);
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    if (values.row(i).cwiseAbs().maxCoeff() > std::numeric_limits<float>::max()) {
      throw std::invalid_argument(row_of(name, i) + "beyond what float32 holds");
    }
  }
}

void require_positive(const char* name, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || values[i] <= 0.0) {
      throw std::invalid_argument(row_of(name, i) + "must be a finite number above 0");
    }
  }
}

void require_mesh(const char* name, const Points& vertices, const Triangles& triangles) {
  if (vertices.rows() == 0) throw std::invalid_argument(std::string(name) + " is empty");
  if (triangles.rows() == 0)
    throw std::invalid_argument("triangles is empty: a mesh needs at least one triangle");
  require_finite(name, vertices);
}

void require_triangles(Eigen::Index n_vertices, const Triangles& triangles) {
  if (n_vertices > most_rows || triangles.rows() > most_rows) {
    throw std::invalid_argument("triangles: a mesh of this size is not supported");
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto row = triangles.row(t);
    for (int c = 0; c < 3; ++c) require_index("triangles", t, "vertex", row[c], n_vertices);
    if (row[0] == row[1] || row[1] == row[2] || row[2] == row[0]) {
      throw std::invalid_argument(row_of("triangles", t) + "names a vertex twice");
    }
  }
}

void require_stiffness(const Eigen::VectorXd& stiffness, const Triangles& triangles) {
  if (stiffness.size() == 0) return;
  require_rows("stiffness", stiffness.size(), triangles.rows(), "triangle");
  require_positive("stiffness", stiffness);
}

}  // namespace planar
