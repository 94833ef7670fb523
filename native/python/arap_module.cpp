// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "choices.h"
#include "planar/arap.h"

namespace py = pybind11;

namespace planar::python {
namespace {

std::pair<Points, Points> py_arap_two_step(py::handle rest, py::handle triangles, py::handle handles,
                                           py::handle targets, double handle_weight,
                                           const std::string& weights) {
  const Points x = to_points("rest", rest);
  const Triangles t = to_triangles(triangles);
  const Handles h = to_handles(handles, t, x.rows());
  const Points u = to_points("targets", targets, h.size());
  const ArapWeights kind = to_arap_weights(weights);
  const py::gil_scoped_release unlocked;
  ArapSteps steps = arap_two_step(x, t, h, u, handle_weight, kind);
  return {std::move(steps.similar), std::move(steps.final)};
}

}  // namespace

void bind_arap(py::module_& m) {
  m.def("arap_two_step", &py_arap_two_step, py::arg("rest"), py::arg("triangles"), py::arg("handles"),
        py::arg("targets"), py::kw_only(), py::arg("handle_weight") = 1000.0,
        py::arg("weights") = "cotangent",
        R"(arap_two_step(rest, triangles, handles, targets, *, handle_weight=1000.0, weights="cotangent")

The mesh with its handles at their targets, as rigid as possible in two linear steps.

Step 1 [ARAP09 4] lets each edge turn and scale with the 3 or 4 corners of its triangles; step 2 [ARAP09 7] gives the edges
of step 1 their lengths at rest. As corrected: similarities are fitted about the corners' mean, and normalised to rotations.

rest n x 2, triangles m x 3, handles k (see the module), targets k x 2; handle_weight is that of a handle's squared distance
from its target, without unit. An edge's weight is half the sum of the cotangents opposite to it, clamped at 0 ("cotangent"),
or 1 ("uniform").
Returns (similar, final), the results of the steps, n x 2 each. A connected part without a handle stays; one whose handles all
lie at one point is moved, not turned. Nothing keeps triangles from turning over.
Raises ValueError (shape, dtype, not finite, index out of range, unknown weights) and SolveError.)");
}

}  // namespace planar::python
