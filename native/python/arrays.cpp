// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"

#include <pybind11/numpy.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace planar::python {
namespace {

// The factorization counts non-zeros in 32 bits and a vertex brings some thirty of them. The limit also keeps
// a broadcast array, which costs its maker nothing, from asking for more memory than there is.
constexpr py::ssize_t kMaxRows = std::numeric_limits<int>::max() / 32;

[[noreturn]] void refuse(const std::string& name, const std::string& problem) {
  throw std::invalid_argument(name + ": " + problem);
}

[[noreturn]] void refuse_row(const std::string& name, Eigen::Index row, const std::string& problem) {
  refuse(name + ", row " + std::to_string(row), problem);
}

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    if (axis > 0) text += ", ";
    text += std::to_string(array.shape(axis));
  }
  return text + (array.ndim() == 1 ? ",)" : ")");
}

py::array as_array(const std::string& name, py::handle value) {
  try {
    return py::array(py::module_::import("numpy").attr("asarray")(value));
  } catch (const py::error_already_set& error) {
    // What NumPy says of a ragged list is the caller's data at fault; anything else (MemoryError, an
    // interrupt) is not.
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    refuse(name, std::string("not an array: ") + py::str(error.value()).cast<std::string>());
  }
}

// `columns` 1 asks for a vector.
py::array checked_array(const std::string& name, py::handle value, const char* kinds, const char* wanted,
                        Eigen::Index rows, int columns) {
  py::array array = as_array(name, value);
  if (std::string(kinds).find(array.dtype().kind()) == std::string::npos) {
    refuse(name, "dtype " + py::str(array.dtype()).cast<std::string>() + ", expected " + wanted);
  }
  const bool vector = columns == 1;
  const bool fits = array.ndim() == (vector ? 1 : 2) && (vector || array.shape(1) == columns) &&
                    (rows == kAnyRows || array.shape(0) == rows);
  if (!fits) {
    const std::string first = rows == kAnyRows ? "n" : std::to_string(rows);
    refuse(name, "shape " + shape_text(array) + ", expected (" + first +
                     (vector ? ",)" : ", " + std::to_string(columns) + ")"));
  }
  if (array.shape(0) > kMaxRows) {
    refuse(name,
           std::to_string(array.shape(0)) + " rows, at most " + std::to_string(kMaxRows) + " are possible");
  }
  return array;
}

// Row after row. Copied as bytes, since NumPy's arrays may begin at any address.
template <typename Number>
std::vector<Number> entries(const py::array& source) {
  const py::array_t<Number, py::array::c_style | py::array::forcecast> array(source);
  std::vector<Number> result(static_cast<std::size_t>(array.size()));
  if (!result.empty()) std::memcpy(result.data(), array.data(), result.size() * sizeof(Number));
  return result;
}

template <typename Matrix>
Matrix to_reals(const std::string& name, py::handle value, Eigen::Index rows, int columns) {
  const py::array array = checked_array(name, value, "fiu", "real numbers", rows, columns);
  Matrix result(array.shape(0), columns);
  Eigen::Index i = 0;
  for (const double entry : entries<double>(array)) {
    if (!std::isfinite(entry)) refuse_row(name, i / columns, "not a finite number");
    result.data()[i++] = entry;
  }
  return result;
}

template <typename Wide, typename Matrix>
Matrix narrow(const std::string& name, const py::array& array, int columns) {
  Matrix result(array.shape(0), columns);
  Eigen::Index i = 0;
  for (const Wide entry : entries<Wide>(array)) {
    if (!std::in_range<int>(entry)) {
      refuse_row(name, i / columns, std::to_string(entry) + " is no index");
    }
    result.data()[i++] = static_cast<int>(entry);
  }
  return result;
}

template <typename Matrix>
Matrix to_integers(const std::string& name, py::handle value, Eigen::Index rows, int columns) {
  const py::array array = checked_array(name, value, "iu", "integers", rows, columns);
  return array.dtype().kind() == 'u' ? narrow<std::uint64_t, Matrix>(name, array, columns)
                                     : narrow<std::int64_t, Matrix>(name, array, columns);
}

}  // namespace

Points to_points(const std::string& name, py::handle value, Eigen::Index rows) {
  return to_reals<Points>(name, value, rows, 2);
}

Triangles to_triangles(py::handle value) { return to_integers<Triangles>("triangles", value, kAnyRows, 3); }

Edges to_edges(const std::string& name, py::handle value) {
  return to_integers<Edges>(name, value, kAnyRows, 2);
}

Eigen::VectorXd to_numbers(const std::string& name, py::handle value, Eigen::Index rows) {
  return value.is_none() ? Eigen::VectorXd() : to_reals<Eigen::VectorXd>(name, value, rows, 1);
}

Eigen::VectorXi to_indices(const std::string& name, py::handle value, Eigen::Index rows) {
  return value.is_none() ? Eigen::VectorXi() : to_integers<Eigen::VectorXi>(name, value, rows, 1);
}

Handles to_handles(py::handle value, const Triangles& triangles, Eigen::Index n_vertices) {
  if (!py::isinstance<py::tuple>(value)) {
    return Handles::at_vertices(to_integers<Eigen::VectorXi>("handles", value, kAnyRows, 1), n_vertices);
  }
  const auto pair = py::reinterpret_borrow<py::tuple>(value);
  if (pair.size() != 2) {
    refuse("handles", "a tuple of " + std::to_string(pair.size()) +
                          ", expected (triangle indices, barycentric weights) or an array of vertex indices");
  }
  using Barycentric = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const auto triangle = to_integers<Eigen::VectorXi>("handles", pair[0], kAnyRows, 1);
  const auto weights = to_reals<Barycentric>("barycentric", pair[1], triangle.size(), 3);
  return Handles::in_triangles(triangle, weights, triangles, n_vertices);
}

}  // namespace planar::python
