// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"

#include <algorithm>
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

// In place of a number of columns.
constexpr int kVector = 0;

using Table = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

py::array checked_array(const std::string& name, py::handle value, const char* kinds, const char* wanted,
                        Eigen::Index rows, int columns) {
  py::array array = as_array(name, value);
  if (std::string(kinds).find(array.dtype().kind()) == std::string::npos) {
    // NumPy makes real numbers of an empty list.
    refuse(name, (array.size() == 0 ? "empty, of dtype " : "dtype ") +
                     py::str(array.dtype()).cast<std::string>() + ", expected " + wanted);
  }
  const bool vector = columns == kVector;
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

enum class Missing { refused, allowed };  // entries that are no numbers

template <typename Matrix>
Matrix to_reals(const std::string& name, py::handle value, Eigen::Index rows, int columns,
                Missing missing = Missing::refused) {
  const py::array array = checked_array(name, value, "fiu", "real numbers", rows, columns);
  const int width = std::max(columns, 1);
  Matrix result(array.shape(0), width);
  Eigen::Index i = 0;
  for (const double entry : entries<double>(array)) {
    const bool allowed = missing == Missing::allowed && std::isnan(entry);
    if (!allowed && !std::isfinite(entry)) refuse_row(name, i / width, "not a finite number");
    result.data()[i++] = entry;
  }
  return result;
}

template <typename Wide, typename Matrix>
Matrix narrow(const std::string& name, const py::array& array, int columns) {
  const int width = std::max(columns, 1);
  Matrix result(array.shape(0), width);
  Eigen::Index i = 0;
  for (const Wide entry : entries<Wide>(array)) {
    if (!std::in_range<int>(entry)) {
      refuse_row(name, i / width, std::to_string(entry) + " is no index");
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

namespace {

// Of a table of numbers; 0 for what is none.
int columns_of(const std::string& name, py::handle value) {
  const py::array array = as_array(name, value);
  return array.ndim() == 2 && array.shape(1) <= 3 ? static_cast<int>(array.shape(1)) : 0;
}

}  // namespace

Coordinates to_coordinates(const std::string& name, py::handle value, Eigen::Index rows, int columns) {
  const py::array array = as_array(name, value);
  if (columns == kAnyColumns) columns = columns_of(name, array) == 3 ? 3 : 2;
  return to_reals<Coordinates>(name, array, rows, columns);
}

std::variant<Triangles, Edges> to_mesh_elements(const std::string& name, py::handle value) {
  const py::array array = as_array(name, value);
  if (columns_of(name, array) == 2) return to_integers<Edges>(name, array, kAnyRows, 2);
  return to_integers<Triangles>(name, array, kAnyRows, 3);
}

LatticeWeights to_weights(const std::string& name, py::handle value, Eigen::Index rows,
                          Eigen::Index columns) {
  if (!is_sequence(value)) refuse(name, "expected (indptr, indices, values)");
  const py::list parts = items_of(value);
  if (parts.size() != 3) {
    refuse(name, std::to_string(parts.size()) + " arrays, expected (indptr, indices, values)");
  }
  const auto start = to_integers<Eigen::VectorXi>(name + " indptr", parts[0], rows + 1, kVector);
  const auto column = to_integers<Eigen::VectorXi>(name + " indices", parts[1], kAnyRows, kVector);
  const auto entry = to_reals<Eigen::VectorXd>(name + " values", parts[2], column.size(), kVector);
  if (start[0] != 0 || start[rows] != column.size()) {
    refuse(name + " indptr", "must lead from 0 to " + std::to_string(column.size()));
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (start[i + 1] < start[i]) refuse_row(name + " indptr", i + 1, "below the row before");
  }
  for (Eigen::Index e = 0; e < column.size(); ++e) {
    if (column[e] < 0 || column[e] >= columns) {
      refuse_row(
          name + " indices", e,
          "point " + std::to_string(column[e]) + " is out of range, there are " + std::to_string(columns));
    }
  }
  LatticeWeights result(rows, columns);
  result.resizeNonZeros(column.size());
  std::copy(start.begin(), start.end(), result.outerIndexPtr());
  std::copy(column.begin(), column.end(), result.innerIndexPtr());
  std::copy(entry.begin(), entry.end(), result.valuePtr());
  return result;
}

Triangles to_triangles(py::handle value) { return to_integers<Triangles>("triangles", value, kAnyRows, 3); }

Edges to_edges(const std::string& name, py::handle value) {
  return to_integers<Edges>(name, value, kAnyRows, 2);
}

Eigen::VectorXd to_numbers(const std::string& name, py::handle value, Eigen::Index rows) {
  return value.is_none() ? Eigen::VectorXd() : to_reals<Eigen::VectorXd>(name, value, rows, kVector);
}

Eigen::VectorXi to_indices(const std::string& name, py::handle value, Eigen::Index rows) {
  return value.is_none() ? Eigen::VectorXi() : to_integers<Eigen::VectorXi>(name, value, rows, kVector);
}

int to_whole(const std::string& name, py::handle value) {
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) {
    const py::error_already_set error;
    if (!error.matches(PyExc_TypeError)) throw error;
    refuse(name, "not a whole number");
  }
  int overflow = 0;
  const long long result = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || !std::in_range<int>(result)) {
    refuse(name, py::str(index).cast<std::string>() + " is out of range");
  }
  return static_cast<int>(result);
}

Eigen::MatrixXi to_whole_table(const std::string& name, py::handle value, Eigen::Index rows) {
  if (value.is_none()) return {};
  // Looked at once: what an object says of itself may change from one time to the next.
  const py::array array = as_array(name, value);
  if (array.ndim() == 0) return Eigen::MatrixXi::Constant(rows, 1, to_whole(name, array));
  if (array.ndim() == 1) return to_integers<Eigen::VectorXi>(name, array, kAnyRows, kVector);
  if (array.ndim() == 2 && array.size() > 0 && array.shape(1) <= kMaxRows) {
    return to_integers<Table>(name, array, kAnyRows, static_cast<int>(array.shape(1)));
  }
  refuse(name, "shape " + shape_text(array) + ", expected a whole number, a vector or a table of them");
}

Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> to_flag_table(const std::string& name, py::handle value) {
  if (value.is_none()) return {};
  const py::array array = as_array(name, value);
  if (array.ndim() != 2 || array.dtype().kind() != 'b') {
    refuse(name, "shape " + shape_text(array) + " of dtype " + py::str(array.dtype()).cast<std::string>() +
                     ", expected a table of truths");
  }
  using Flags = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::vector<std::uint8_t> flags = entries<std::uint8_t>(array);
  Flags result(array.shape(0), array.shape(1));
  std::transform(flags.begin(), flags.end(), result.data(), [](std::uint8_t flag) { return flag != 0; });
  return result;
}

bool is_sequence(py::handle value) {
  if (py::isinstance<py::array>(value)) return py::reinterpret_borrow<py::array>(value).ndim() > 0;
  return py::isinstance<py::sequence>(value) && !py::isinstance<py::str>(value);
}

py::list items_of(py::handle sequence) {
  // py::list() would take a list as it is.
  auto items = py::reinterpret_steal<py::list>(PySequence_List(sequence.ptr()));
  if (!items) throw py::error_already_set();
  return items;
}

namespace {

std::vector<Points> tables_of(const std::string& name, py::handle value, Missing missing) {
  std::vector<Points> tables;
  for (const py::handle table : items_of(value)) {
    const std::string item = name + "[" + std::to_string(tables.size()) + "]";
    tables.push_back(to_reals<Points>(item, table, kAnyRows, 2, missing));
  }
  return tables;
}

}  // namespace

std::vector<Points> to_shapes(const std::string& name, py::handle value) {
  if (!is_sequence(value)) refuse(name, "expected an array of shapes, (k, n, 2)");
  return tables_of(name, value, Missing::refused);
}

std::vector<Points> to_paths(const std::string& name, py::handle value) {
  if (value.is_none()) return {};
  if (!is_sequence(value)) refuse(name, "expected an array of places, (f, k, 2)");
  return tables_of(name, value, Missing::allowed);
}

Elements to_elements(py::handle triangles, py::handle edges) {
  if (triangles.is_none() == edges.is_none()) {
    throw std::invalid_argument("triangles, edges: give one of the two");
  }
  if (!triangles.is_none()) return to_triangles(triangles);
  return to_edges("edges", edges);
}

Handles to_handles(py::handle value, const Triangles& triangles, Eigen::Index n_vertices) {
  if (!py::isinstance<py::tuple>(value)) {
    return Handles::at_vertices(to_integers<Eigen::VectorXi>("handles", value, kAnyRows, kVector),
                                n_vertices);
  }
  const auto pair = py::reinterpret_borrow<py::tuple>(value);
  if (pair.size() != 2) {
    refuse("handles", "a tuple of " + std::to_string(pair.size()) +
                          ", expected (triangle indices, barycentric weights) or an array of vertex indices");
  }
  using Barycentric = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const auto triangle = to_integers<Eigen::VectorXi>("handles", pair[0], kAnyRows, kVector);
  const auto weights = to_reals<Barycentric>("barycentric", pair[1], triangle.size(), 3);
  return Handles::in_triangles(triangle, weights, triangles, n_vertices);
}

namespace {

// An image's numbers, row after row, and what they are to be multiplied by.
struct ImageNumbers {
  py::array_t<float, py::array::c_style | py::array::forcecast> values;
  float scale;
};

ImageNumbers image_numbers(const std::string& name, const py::array& array) {
  const char kind = array.dtype().kind();
  const py::ssize_t bytes = array.dtype().itemsize();
  if (kind != 'f' && kind != 'b' && (kind != 'u' || bytes > 2)) {
    refuse(name, "dtype " + py::str(array.dtype()).cast<std::string>() +
                     ", expected real numbers, truths or unsigned numbers of one or two bytes");
  }
  for (int axis = 0; axis < 2; ++axis) {
    if (array.shape(axis) <= most_pixels) continue;
    refuse(name, "shape " + shape_text(array) + ", at most " + std::to_string(most_pixels) +
                     " pixels a side are possible: make the image smaller");
  }
  return {array, kind != 'u' ? 1.0f : bytes == 1 ? 1.0f / 255.0f : 1.0f / 65535.0f};
}

}  // namespace

AlphaImage to_alpha(const std::string& name, py::handle value) {
  const py::array array = as_array(name, value);
  if (array.ndim() != 2) refuse(name, "shape " + shape_text(array) + ", expected (height, width)");
  const auto [values, scale] = image_numbers(name, array);
  return scale * Eigen::Map<const AlphaImage>(values.data(), values.shape(0), values.shape(1));
}

Colours to_colours(const std::string& name, py::handle value, Eigen::Index* height, Eigen::Index* width) {
  const py::array array = as_array(name, value);
  if (array.ndim() != 3 || (array.shape(2) != 3 && array.shape(2) != 4)) {
    refuse(name, "shape " + shape_text(array) + ", expected (height, width, 3 or 4)");
  }
  const auto [values, scale] = image_numbers(name, array);
  *height = values.shape(0);
  *width = values.shape(1);
  using Channels = Eigen::Map<const AlphaImage>;
  return scale * Channels(values.data(), *height * *width, values.shape(2)).leftCols<3>();
}

py::array_t<double> frames_array(const std::vector<Points>& frames, Eigen::Index n_vertices) {
  py::array_t<double> array(
      {static_cast<py::ssize_t>(frames.size()), static_cast<py::ssize_t>(n_vertices), py::ssize_t{2}});
  double* out = array.mutable_data();
  for (const Points& frame : frames) {
    std::memcpy(out, frame.data(), static_cast<std::size_t>(frame.size()) * sizeof(double));
    out += frame.size();
  }
  return array;
}

}  // namespace planar::python
