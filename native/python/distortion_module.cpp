// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include <sstream>
#include <string>

#include "arrays.h"
#include "bindings.h"
#include "planar/distortion.h"

namespace py = pybind11;

namespace planar::python {
namespace {

Distortion py_distortion(py::handle rest, py::handle posed, py::handle triangles) {
  const Points x = to_points("rest", rest);
  const Points y = to_points("posed", posed, x.rows());
  const Triangles t = to_triangles(triangles);
  const py::gil_scoped_release unlocked;
  return distortion(x, y, t);
}

std::string distortion_text(const Distortion& value) {
  std::ostringstream text;
  text << "Distortion(area=" << value.area << ", angle=" << value.angle << ", flipped=" << value.flipped
       << ")";
  return text.str();
}

}  // namespace

void bind_distortion(py::module_& m) {
  auto distortion_class =
      py::class_<Distortion>(m, "Distortion",
                             "Area and angle distortion of a posed mesh (AKVF, section 3.3).",
                             made_by_the_library())
          .def_readonly("area", &Distortion::area, "E_area of the whole mesh; 2 is none.")
          .def_readonly("angle", &Distortion::angle, "E_angle of the whole mesh; 2 is none.")
          .def_readonly(
              "flipped", &Distortion::flipped,
              "Triangles of opposite orientation than at rest, judged on float32-rounded positions.")
          .def_readonly("triangle_area", &Distortion::triangle_area, "E_area of each triangle, m.")
          .def_readonly("triangle_angle", &Distortion::triangle_angle, "E_angle of each triangle, m.")
          .def_readonly("triangle_flipped", &Distortion::triangle_flipped,
                        "Whether each triangle is counted as flipped, m.")
          .def("__repr__", &distortion_text);
  distortion_class.attr("__module__") = "planar_native";

  m.def("distortion", &py_distortion, py::arg("rest"), py::arg("posed"), py::arg("triangles"),
        R"(distortion(rest, posed, triangles)

Area and angle distortion between two shapes of a mesh [AKVF, section 3.3] and its flipped triangles.

rest n x 2, posed n x 2, triangles m x 3. Returns a Distortion; 2 is no distortion, and so count triangles that
nobody can see at rest (area below 1e-6 of the median one of their part, or altitude below 1e-3). Raises ValueError.)");
}

}  // namespace planar::python
