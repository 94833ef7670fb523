// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include "arrays.h"
#include "bindings.h"
#include "planar/akvf.h"

namespace py = pybind11;

namespace planar::python {
namespace {

Points py_killing_field(py::handle vertices, py::handle triangles, py::handle handles, py::handle velocities,
                        double pin_weight, bool hard, bool dirichlet, py::handle stiffness) {
  const Points x = to_points("vertices", vertices);
  const Triangles t = to_triangles(triangles);
  const Handles h = to_handles(handles, t, x.rows());
  const Points u = to_points("velocities", velocities, h.size());
  const KillingOptions options{pin_weight, hard, dirichlet, to_numbers("stiffness", stiffness, t.rows())};
  const py::gil_scoped_release unlocked;
  return killing_field(x, t, h, u, options);
}

}  // namespace

void bind_akvf(py::module_& m) {
  m.def(
      "killing_field", &py_killing_field, py::arg("vertices"), py::arg("triangles"), py::arg("handles"),
      py::arg("velocities"), py::kw_only(), py::arg("pin_weight") = 1.0, py::arg("hard").noconvert() = false,
      py::arg("dirichlet").noconvert() = true, py::arg("stiffness") = py::none(),
      R"(killing_field(vertices, triangles, handles, velocities, *, pin_weight=1.0, hard=False, dirichlet=True, stiffness=None)

The as-Killing-as-possible vector field that follows the handles' velocities.

Solves [AKVF 7]: the least Killing energy
plus pin_weight times the squared errors at the handles; then, with `dirichlet`, [AKVF 8]: the same energy with the boundary
vertices fixed to the first solution.

vertices n x 2, triangles m x 3, handles k (see the module), velocities k x 2 in the unit of the vertices; pin_weight is
the lambda squared of [AKVF 7], without unit, ignored where `hard` makes the handles exact; stiffness is a positive factor per
triangle, m.
Returns n x 2 velocities. A connected part without a handle stays; one whose handles all lie at one point translates with the
mean of their velocities. Very thin triangles are stiffened as if they were a little thicker.
Raises ValueError (shape, dtype, not finite, index out of range) and SolveError.)");
}

}  // namespace planar::python
