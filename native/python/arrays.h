// SPDX-License-Identifier: GPL-3.0-or-later
// From Python arguments to the library's matrices. Every function copies, so that the caller may change his
// arrays while a solve runs without the GIL; each throws std::invalid_argument (ValueError in Python) that
// begins with the name of the argument and, where one entry is at fault, gives its row. Ranges (is this index
// a vertex?) are the library's to check.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "planar/handle.h"
#include "planar/inbetween.h"
#include "planar/types.h"

namespace planar::python {

// Stands for a number of rows that follows from the argument itself.
inline constexpr Eigen::Index kAnyRows = -1;

// rows×2 finite numbers.
Points to_points(const std::string& name, pybind11::handle value, Eigen::Index rows = kAnyRows);

// m×3 integers.
Triangles to_triangles(pybind11::handle value);

// m×2 integers.
Edges to_edges(const std::string& name, pybind11::handle value);

// `rows` finite numbers; None gives an empty vector.
Eigen::VectorXd to_numbers(const std::string& name, pybind11::handle value, Eigen::Index rows);

// `rows` integers; None gives an empty vector.
Eigen::VectorXi to_indices(const std::string& name, pybind11::handle value, Eigen::Index rows = kAnyRows);

// An integer array of k vertices, or a tuple (k triangle indices, k×3 barycentric weights).
Handles to_handles(pybind11::handle value, const Triangles& triangles, Eigen::Index n_vertices);

}  // namespace planar::python
