// SPDX-License-Identifier: GPL-3.0-or-later
// From Python arguments to the library's matrices. Every function copies, so that the caller may change his
// arrays while a solve runs without the GIL; each throws std::invalid_argument (ValueError in Python) that
// begins with the name of the argument and, where one entry is at fault, gives its row. Ranges (is this index
// a vertex?) are the library's to check.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <variant>
#include <vector>

#include "planar/cutout.h"
#include "planar/handle.h"
#include "planar/lattice.h"
#include "planar/types.h"

namespace planar::python {

// Stands for a number of rows that follows from the argument itself.
inline constexpr Eigen::Index kAnyRows = -1;

// rows×2 finite numbers.
Points to_points(const std::string& name, pybind11::handle value, Eigen::Index rows = kAnyRows);

// rows×2 or rows×3 finite numbers, as many columns as `columns` says if it is not kAnyColumns.
inline constexpr int kAnyColumns = -1;
Coordinates to_coordinates(const std::string& name, pybind11::handle value, Eigen::Index rows = kAnyRows,
                           int columns = kAnyColumns);

// (indptr rows+1, indices, values): a sparse matrix by rows.
LatticeWeights to_weights(const std::string& name, pybind11::handle value, Eigen::Index rows,
                          Eigen::Index columns);

// m×3 or m×2 integers.
std::variant<Triangles, Edges> to_mesh_elements(const std::string& name, pybind11::handle value);

// m×3 integers.
Triangles to_triangles(pybind11::handle value);

// m×2 integers.
Edges to_edges(const std::string& name, pybind11::handle value);

// `rows` finite numbers; None gives an empty vector.
Eigen::VectorXd to_numbers(const std::string& name, pybind11::handle value, Eigen::Index rows);

// `rows` integers; None gives an empty vector.
Eigen::VectorXi to_indices(const std::string& name, pybind11::handle value, Eigen::Index rows = kAnyRows);

// A whole number: anything with __index__, NumPy's integers among it.
int to_whole(const std::string& name, pybind11::handle value);

// A whole number for all rows, rows of them, or rows×columns; None gives an empty matrix.
Eigen::MatrixXi to_whole_table(const std::string& name, pybind11::handle value, Eigen::Index rows);

// Truths, rows×columns; None gives an empty table.
Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> to_flag_table(const std::string& name,
                                                                 pybind11::handle value);

// Whether Python would iterate over it and it is no text.
bool is_sequence(pybind11::handle value);

// What a sequence holds, which stays alive with the list, whatever becomes of the sequence.
pybind11::list items_of(pybind11::handle sequence);

// f×n×2, or a sequence of n×2.
std::vector<Points> to_shapes(const std::string& name, pybind11::handle value);

// The same with entries that may be no numbers; None gives none.
std::vector<Points> to_paths(const std::string& name, pybind11::handle value);

inline Eigen::Index vertices_of(const std::vector<Points>& shapes) {
  return shapes.empty() ? 0 : shapes[0].rows();
}

// The one of the two that is not None.
using Elements = std::variant<Triangles, Edges>;
Elements to_elements(pybind11::handle triangles, pybind11::handle edges);

// An integer array of k vertices, or a tuple (k triangle indices, k×3 barycentric weights).
Handles to_handles(pybind11::handle value, const Triangles& triangles, Eigen::Index n_vertices);

// h×w real numbers as they are, truths, or whole numbers of one or two bytes that stand for 0 to 1.
AlphaImage to_alpha(const std::string& name, pybind11::handle value);

// h×w×3 or h×w×4 of the same; the fourth is left out.
Colours to_colours(const std::string& name, pybind11::handle value, Eigen::Index* height,
                   Eigen::Index* width);

// The other way: frames of n_vertices each as f×n×2.
pybind11::array_t<double> frames_array(const std::vector<Points>& frames, Eigen::Index n_vertices);

}  // namespace planar::python
