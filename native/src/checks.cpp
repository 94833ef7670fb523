// SPDX-License-Identifier: GPL-3.0-or-later
#include "checks.h"

#include <cmath>

namespace planar {

std::string row_of(const char* name, Eigen::Index row) {
  return std::string(name) + ", row " + std::to_string(row) + ": ";
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

void require_stiffness(const Eigen::VectorXd& stiffness, const Triangles& triangles) {
  if (stiffness.size() == 0) return;
  require_rows("stiffness", stiffness.size(), triangles.rows(), "triangle");
  require_positive("stiffness", stiffness);
}

}  // namespace planar
