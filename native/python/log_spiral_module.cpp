// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include "arrays.h"
#include "bindings.h"
#include "planar/log_spiral.h"

namespace py = pybind11;

namespace planar::python {
namespace {

Points py_advance_along_spirals(py::handle vertices, py::handle triangles, py::handle velocities) {
  const Points x = to_points("vertices", vertices);
  const Triangles t = to_triangles(triangles);
  const Points u = to_points("velocities", velocities, x.rows());
  const py::gil_scoped_release unlocked;
  return advance_along_spirals(x, t, u);
}

}  // namespace

void bind_log_spiral(py::module_& m) {
  m.def("advance_along_spirals", &py_advance_along_spirals, py::arg("vertices"), py::arg("triangles"),
        py::arg("velocities"),
        R"(advance_along_spirals(vertices, triangles, velocities)

Moves each vertex for unit time along the logarithmic spirals that a velocity field draws on its edges.

[AKVF 14-16], as the mean over a vertex's edges of p + u (e^z - 1)/z with z the quotient of velocity and
position difference along the edge: a field of rotation turns the mesh rigidly, by any angle below pi.

vertices n x 2, triangles m x 3, velocities n x 2 in the unit of the vertices.
Returns n x 2 positions; isolated vertices stay. Raises ValueError, and SolveError where a spiral overflows.)");
}

}  // namespace planar::python
