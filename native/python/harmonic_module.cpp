// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include "arrays.h"
#include "bindings.h"
#include "planar/harmonic.h"

namespace py = pybind11;

namespace planar::python {
namespace {

Eigen::VectorXd py_harmonic(py::handle rest, py::handle triangles, py::handle held, py::handle values) {
  const Points x = to_points("rest", rest);
  const Triangles t = to_triangles(triangles);
  const Eigen::VectorXi vertices = to_indices("held", held);
  const Eigen::VectorXd given = to_numbers("values", values, vertices.size());
  const py::gil_scoped_release unlocked;
  return harmonic(x, t, vertices, given);
}

}  // namespace

void bind_harmonic(py::module_& m) {
  m.def("harmonic", &py_harmonic, py::arg("rest"), py::arg("triangles"), py::arg("held"), py::arg("values"),
        R"(harmonic(rest, triangles, held, values)

Values of some vertices of a mesh, spread over the others by the discrete harmonic function.

rest n x 2, triangles m x 3, held k different vertices, values k. Returns n, none of which is beyond the values;
0 in parts with nothing held. Raises ValueError and SolveError.)");
}

}  // namespace planar::python
