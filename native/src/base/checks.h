// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "planar/types.h"

/// Checks of the caller's data. Each throws std::invalid_argument that names the argument and its first row
/// at fault.
namespace planar {

/// What the indices of a sparse factor can count: some thirty non-zeros a row.
constexpr Eigen::Index most_rows = std::numeric_limits<int>::max() / 32;

/// 0 <= index < count, the number of things of that `kind`.
void require_index(const char* name, Eigen::Index row, const char* kind, Eigen::Index index,
                   Eigen::Index count);
void require_rows(const char* name, Eigen::Index rows, Eigen::Index expected, const char* of);
void require_finite(const char* name, const Eigen::Ref<const Points>& values);
/// The same for any number of columns.
void require_finite_rows(
    const char* name, const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& values);
/// No coordinate is beyond what float32 holds, as Blender stores it.
void require_float32(const char* name, const Eigen::Ref<const Points>& values);
void require_positive(const char* name, const Eigen::Ref<const Eigen::VectorXd>& values);

/// `vertices` and `triangles` make a mesh: finite rows, at least one triangle (the indices are checked by
/// require_triangles).
void require_mesh(const char* name, const Points& vertices, const Triangles& triangles);

/// Each triangle names three different vertices of n, and there are not too many of either.
void require_triangles(Eigen::Index n_vertices, const Triangles& triangles);

/// Empty, or a number above 0 for every triangle.
void require_stiffness(const Eigen::VectorXd& stiffness, const Triangles& triangles);

/// Empty, or vertices enough for a shape.
void require_cage(const std::optional<int>& cage);

std::string row_of(const char* name, Eigen::Index row);

}  // namespace planar
