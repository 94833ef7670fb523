// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <variant>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "planar/transfer.h"

namespace py = pybind11;

namespace planar::python {
namespace {

py::array_t<double> py_transfer_motion(py::handle frames, py::handle shape, py::handle triangles,
                                       py::handle edges) {
  const std::vector<Points> source = to_shapes("frames", frames);
  const Points first = to_points("shape", shape);
  const Elements elements = to_elements(triangles, edges);
  std::vector<Points> result;
  {
    const py::gil_scoped_release unlocked;
    result = std::visit([&](const auto& e) { return transfer_motion(source, first, e); }, elements);
  }
  return frames_array(result, vertices_of(source));
}

}  // namespace

void bind_transfer(py::module_& m) {
  m.def("transfer_motion", &py_transfer_motion, py::arg("frames"), py::arg("shape"), py::kw_only(),
        py::arg("triangles") = py::none(), py::arg("edges") = py::none(),
        R"(transfer_motion(frames, shape, *, triangles=None, edges=None)

The motion of frames, made by another drawing of the same connectivity [AIAP, section 5.1].

frames f x n x 2; shape n x 2, that of the other drawing where the source is frames[0]; one of triangles m x 3 and edges m x 2.
Returns f x n x 2, the first of which is shape. Raises ValueError and SolveError.)");
}

}  // namespace planar::python
