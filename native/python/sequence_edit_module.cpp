// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "planar/sequence_edit.h"

namespace py = pybind11;

namespace planar::python {
namespace {

py::array_t<double> py_edit_sequence(py::handle frames, const py::dict& edits, py::handle triangles,
                                     py::handle edges) {
  const std::vector<Points> source = to_shapes("frames", frames);
  std::vector<FrameEdit> changes;
  // The dictionary may change while its shapes are converted.
  for (const py::handle item : py::list(edits.attr("items")())) {
    const auto [frame, shape] = py::cast<std::pair<py::object, py::object>>(item);
    const int number = to_whole("edits, frame " + py::str(frame).cast<std::string>(), frame);
    changes.push_back(
        {number, to_points("edits[" + std::to_string(number) + "]", shape, vertices_of(source))});
  }
  const Elements elements = to_elements(triangles, edges);
  std::vector<Points> result;
  {
    const py::gil_scoped_release unlocked;
    result = std::visit([&](const auto& e) { return edit_sequence(source, changes, e); }, elements);
  }
  return frames_array(result, vertices_of(source));
}

}  // namespace

void bind_sequence_edit(py::module_& m) {
  m.def("edit_sequence", &py_edit_sequence, py::arg("frames"), py::arg("edits"), py::kw_only(),
        py::arg("triangles") = py::none(), py::arg("edges") = py::none(),
        R"(edit_sequence(frames, edits, *, triangles=None, edges=None)

Spreads changes of single frames over their sequence [AIAP, section 5.2].

frames f x n x 2; edits {frame number: n x 2}; one of triangles m x 3 and edges m x 2. With one edit every frame takes it on;
between two it goes evenly from one to the other, so that edits of the first and last frame that change nothing keep them.
Returns f x n x 2, edited frames as given. Raises ValueError and SolveError.)");
}

}  // namespace planar::python
