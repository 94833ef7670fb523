// SPDX-License-Identifier: GPL-3.0-or-later
// The module's face: names, defaults, documentation. Arguments are converted in arrays.cpp.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "arrays.h"
#include "guarded_poser.h"
#include "inbetween_module.h"
#include "planar/akvf.h"
#include "planar/build_info.h"
#include "planar/distortion.h"
#include "planar/log_spiral.h"

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

Points py_advance_along_spirals(py::handle vertices, py::handle triangles, py::handle velocities) {
  const Points x = to_points("vertices", vertices);
  const Triangles t = to_triangles(triangles);
  const Points u = to_points("velocities", velocities, x.rows());
  const py::gil_scoped_release unlocked;
  return advance_along_spirals(x, t, u);
}

Distortion py_distortion(py::handle rest, py::handle posed, py::handle triangles) {
  const Points x = to_points("rest", rest);
  const Points y = to_points("posed", posed, x.rows());
  const Triangles t = to_triangles(triangles);
  const py::gil_scoped_release unlocked;
  return distortion(x, y, t);
}

PoserMethod to_method(const std::string& name) {
  if (name == "hold") return PoserMethod::hold;
  if (name == "akvf") return PoserMethod::akvf;
  throw std::invalid_argument("method: '" + name + "' is not available; there are 'hold' and 'akvf'");
}

std::shared_ptr<GuardedPoser> make_poser(py::handle rest, py::handle triangles, const std::string& method,
                                         std::optional<double> pin_weight, py::handle stiffness) {
  Points x = to_points("rest", rest);
  Triangles t = to_triangles(triangles);
  PoserOptions options;
  options.method = to_method(method);
  options.pin_weight = pin_weight;
  options.stiffness = to_numbers("stiffness", stiffness, t.rows());
  const py::gil_scoped_release unlocked;
  return std::make_shared<GuardedPoser>(std::move(x), t, options);
}

// A Poser made by __new__ alone holds nothing: asked for the holder pybind11 notices, asked for a reference
// not.
using PoserRef = std::shared_ptr<GuardedPoser>;

void py_set_handles(const PoserRef& poser, py::handle handles, py::handle weights, py::handle groups) {
  Handles h = to_handles(handles, poser->triangles(), poser->n_vertices());
  Eigen::VectorXd w = to_numbers("weights", weights, h.size());
  Eigen::VectorXi g = to_indices("groups", groups, h.size());
  const py::gil_scoped_release unlocked;
  poser->set_handles(std::move(h), std::move(w), std::move(g));
}

Points py_move(const PoserRef& poser, py::handle targets) {
  const Points u = to_points("targets", targets);
  const py::gil_scoped_release unlocked;
  return poser->move(u);
}

void py_reset(const PoserRef& poser, py::handle positions) {
  if (positions.is_none()) {
    const py::gil_scoped_release unlocked;
    poser->reset();
    return;
  }
  const Points x = to_points("positions", positions, poser->n_vertices());
  const py::gil_scoped_release unlocked;
  poser->reset(x);
}

py::dict py_build_info() {
  const BuildInfo info = build_info();
  py::dict result;
  result["version"] = info.version;
  result["backend"] = info.backend;
  result["eigen"] = info.eigen;
  result["suitesparse"] = info.suitesparse;
  result["threads"] = info.threads;
  return result;
}

std::string report_text(const Report& report) {
  std::ostringstream text;
  text << "Report(iterations=" << report.iterations << ", substeps=" << report.substeps
       << ", furthest_handle=" << report.furthest_handle << ", flipped=" << report.flipped
       << ", converged=" << (report.converged ? "True" : "False") << ")";
  return text.str();
}

std::string distortion_text(const Distortion& value) {
  std::ostringstream text;
  text << "Distortion(area=" << value.area << ", angle=" << value.angle << ", flipped=" << value.flipped
       << ")";
  return text.str();
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  const auto without_gil = py::call_guard<py::gil_scoped_release>();
  py::options options;
  options.disable_function_signatures();

  auto solve_error = py::register_exception<SolveError>(m, "SolveError", PyExc_RuntimeError);
  solve_error.attr("__module__") = "planar_native";
  solve_error.doc() = "A numerical failure: the data is valid, but the solve did not succeed.";

  auto distortion_class =
      py::class_<Distortion>(m, "Distortion",
                             "Area and angle distortion of a posed mesh (AKVF, section 3.3).")
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

  auto report_class =
      py::class_<Report>(m, "Report", "What the last move, refine or settle of a Poser did.")
          .def_readonly("iterations", &Report::iterations,
                        "Steps towards the targets: a fixed number at most in move and refine, as many as it "
                        "took in settle.")
          .def_readonly(
              "substeps", &Report::substeps,
              "Pieces that were advanced by: with hold one a step, with akvf as many as a step was cut into.")
          .def_readonly("furthest_handle", &Report::furthest_handle,
                        "Largest distance of a handle from its target, in the unit of the positions.")
          .def_readonly(
              "flipped", &Report::flipped,
              "Triangles of opposite orientation than at rest, judged on float32-rounded positions.")
          .def_readonly("converged", &Report::converged,
                        "Whether nothing is left to do: with hold a full Newton step is below 1e-5 of the "
                        "diagonal of the rest's box, with akvf furthest_handle is at most 1e-3 of it.")
          .def("__repr__", &report_text);
  report_class.attr("__module__") = "planar_native";

  m.def(
      "killing_field", &py_killing_field, py::arg("vertices"), py::arg("triangles"), py::arg("handles"),
      py::arg("velocities"), py::kw_only(), py::arg("pin_weight") = 1.0, py::arg("hard").noconvert() = false,
      py::arg("dirichlet").noconvert() = true, py::arg("stiffness") = py::none(),
      R"(killing_field(vertices, triangles, handles, velocities, *, pin_weight=1.0, hard=False, dirichlet=True, stiffness=None)

The as-Killing-as-possible vector field that follows the handles' velocities.

Solves (7) of Solomon et al. 2011, "As-Killing-As-Possible Vector Fields for Planar Deformation": the least Killing energy
plus pin_weight times the squared errors at the handles; then, with `dirichlet`, (8): the same energy with the boundary
vertices fixed to the first solution.

vertices n x 2, triangles m x 3, handles k (see the module), velocities k x 2 in the unit of the vertices; pin_weight is
the lambda squared of (7), without unit, ignored where `hard` makes the handles exact; stiffness is a positive factor per
triangle, m.
Returns n x 2 velocities. A connected part without a handle stays; one whose handles all lie at one point translates with the
mean of their velocities. Very thin triangles are stiffened as if they were a little thicker.
Raises ValueError (shape, dtype, not finite, index out of range) and SolveError.)");

  m.def("advance_along_spirals", &py_advance_along_spirals, py::arg("vertices"), py::arg("triangles"),
        py::arg("velocities"),
        R"(advance_along_spirals(vertices, triangles, velocities)

Moves each vertex for unit time along the logarithmic spirals that a velocity field draws on its edges.

(14)-(16) of Solomon et al. 2011, as the mean over a vertex's edges of p + u (e^z - 1)/z with z the quotient of velocity and
position difference along the edge: a field of rotation turns the mesh rigidly, by any angle below pi.

vertices n x 2, triangles m x 3, velocities n x 2 in the unit of the vertices.
Returns n x 2 positions; isolated vertices stay. Raises ValueError, and SolveError where a spiral overflows.)");

  m.def("distortion", &py_distortion, py::arg("rest"), py::arg("posed"), py::arg("triangles"),
        R"(distortion(rest, posed, triangles)

Area and angle distortion between two shapes of a mesh (Solomon et al. 2011, section 3.3) and its flipped triangles.

rest n x 2, posed n x 2, triangles m x 3. Returns a Distortion; 2 is no distortion, and so count triangles without area at
rest. Raises ValueError.)");

  auto poser_class = py::class_<GuardedPoser, PoserRef>(
      m, "Poser", R"(Poser(rest, triangles, *, method="hold", pin_weight=None, stiffness=None)

Poses a mesh by moving handles. The object keeps the posed shape from one move to the next.

rest n x 2, triangles m x 3. method "hold" looks for the least distortion of the rest shape, sum over the triangles of
stiffness area (|J|^2 + |1/J|^2) (symmetric Dirichlet, J from rest to pose) plus pin_weight times the squared distances of the
handles from their targets, by projected Newton steps in which no triangle inverts. The pose it settles in does not depend on
the path, except where there are several (an arm wound the other way round). Method "akvf" is the as-Killing-as-possible deformation of Solomon et al. 2011,
(7), (8), (14)-(16), in substeps in which no triangle inverts, at most 32 in a move; it forgets the rest shape and departs from
the paper where patches turn and where triangles are squeezed (planar/poser.h says how). pin_weight has no unit (None: 1000);
with akvf it is the lambda squared of (7). stiffness is a positive factor per triangle, m.

    poser = Poser(rest, triangles)
    poser.set_handles([0, 12])
    for targets in path:
        posed = poser.move(targets)
    posed = poser.settle()

Threads may share an object: calls on it wait for each other. Different objects work in parallel.
Raises ValueError (shape, dtype, not finite, index out of range, unknown method) and SolveError.)");
  poser_class.attr("__module__") = "planar_native";
  poser_class
      .def(py::init(&make_poser), py::arg("rest"), py::arg("triangles"), py::kw_only(),
           py::arg("method") = "hold", py::arg("pin_weight") = py::none(), py::arg("stiffness") = py::none())
      .def("set_handles", &py_set_handles, py::arg("handles"), py::kw_only(), py::arg("weights") = py::none(),
           py::arg("groups") = py::none(), R"(set_handles(handles, *, weights=None, groups=None)

Replaces the handles. The shape stays as it is.

handles k (see the module); weights k, positive, multiply pin_weight (None: 1 each); groups k integers: handles of one group
(a patch) share the weight of one pin (None: each handle is its own group). Raises ValueError.)")
      .def("move", &py_move, py::arg("targets"), R"(move(targets)

A bounded number of steps towards targets, k x 2, from the present shape; for each event of a drag. Returns the new positions,
n x 2. Raises ValueError and SolveError; the shape is then the one before the call.)")
      .def(
          "refine", [](const PoserRef& poser) { return poser->refine(); }, without_gil, R"(refine()

One more bounded piece of work towards the last targets, about as much as a move, in which no vertex moves by more than 2 % of
the diagonal of the rest's box; for the frames after the mouse has come to rest, until report.converged. Without targets it does
nothing. Returns the new positions, n x 2. Raises SolveError; the shape is then the one before the call.)")
      .def(
          "settle", [](const PoserRef& poser) { return poser->settle(); }, without_gil, R"(settle()

All that is left to do towards the last targets, within a fixed number of steps; without refine's limit on motion. Without
targets it does nothing. Returns the new positions, n x 2. Raises SolveError; the shape is then the one before the call.)")
      .def("reset", &py_reset, py::arg("positions") = py::none(), R"(reset(positions=None)

Takes positions, n x 2, as the present shape; None takes the rest shape. Handles stay, targets are forgotten. Raises ValueError.)")
      .def_property_readonly(
          "positions",
          py::cpp_function([](const PoserRef& poser) { return poser->positions(); }, without_gil),
          "The present shape, n x 2; a copy.")
      .def_property_readonly(
          "report", py::cpp_function([](const PoserRef& poser) { return poser->report(); }, without_gil),
          "What the last move, refine or settle did, a Report.");

  bind_inbetween(m);

  m.def("build_info", &py_build_info, R"(build_info()

How the module was built: version, backend of the sparse solver, the versions of eigen and suitesparse, and the threads a
solve may use.)");
}

}  // namespace planar::python
