// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "choices.h"
#include "guarded.h"
#include "planar/poser.h"
#include "progress.h"

namespace py = pybind11;

namespace planar::python {
namespace {

// What handles inside triangles are read against never changes, hence needs no lock.
struct SharedPoser {
  SharedPoser(Triangles t, Eigen::Index n, Poser p)
      : triangles(std::move(t)), n_vertices(n), poser(std::move(p)) {}

  Triangles triangles;
  Eigen::Index n_vertices;
  Guarded<Poser> poser;
};

// A Poser made by __new__ alone holds nothing: asked for the holder pybind11 notices, asked for a reference
// not.
using PoserRef = std::shared_ptr<SharedPoser>;

PoserRef make_poser(py::handle rest, py::handle triangles, const std::string& method,
                    std::optional<double> pin_weight, py::handle stiffness, std::optional<int> cage,
                    py::handle progress) {
  Points x = to_points("rest", rest);
  Triangles t = to_triangles(triangles);
  PoserOptions options;
  options.method = to_choice<PoserMethod>(
      "method", method,
      {{"hold", PoserMethod::hold}, {"akvf", PoserMethod::akvf}, {"arap", PoserMethod::arap}});
  options.pin_weight = pin_weight;
  options.stiffness = to_numbers("stiffness", stiffness, t.rows());
  options.cage = cage;
  options.progress = to_progress(progress);
  const Eigen::Index n_vertices = x.rows();
  const py::gil_scoped_release unlocked;
  Poser poser(std::move(x), t, options);
  return std::make_shared<SharedPoser>(std::move(t), n_vertices, std::move(poser));
}

void py_set_handles(const PoserRef& shared, py::handle handles, py::handle weights, py::handle groups) {
  Handles h = to_handles(handles, shared->triangles, shared->n_vertices);
  Eigen::VectorXd w = to_numbers("weights", weights, h.size());
  Eigen::VectorXi g = to_indices("groups", groups, h.size());
  shared->poser.with([&](Poser& poser) { poser.set_handles(std::move(h), std::move(w), std::move(g)); });
}

void py_set_joints(const PoserRef& shared, py::handle first, py::handle second, py::handle strength) {
  const Handles a = to_handles(first, shared->triangles, shared->n_vertices);
  const Handles b = to_handles(second, shared->triangles, shared->n_vertices);
  const Eigen::VectorXd s = to_numbers("strength", strength, a.size());
  shared->poser.with([&](Poser& poser) { poser.set_joints(a, b, s); });
}

Points py_move(const PoserRef& shared, py::handle targets) {
  const Points u = to_points("targets", targets);
  return shared->poser.with([&u](Poser& poser) { return poser.move(u); });
}

void py_reset(const PoserRef& shared, py::handle positions) {
  if (positions.is_none()) {
    shared->poser.with([](Poser& poser) { poser.reset(); });
    return;
  }
  const Points x = to_points("positions", positions, shared->n_vertices);
  shared->poser.with([&x](Poser& poser) { poser.reset(x); });
}

std::string report_text(const Report& report) {
  std::ostringstream text;
  text << "Report(iterations=" << report.iterations << ", substeps=" << report.substeps
       << ", furthest_handle=" << report.furthest_handle << ", flipped=" << report.flipped
       << ", converged=" << (report.converged ? "True" : "False")
       << ", coarse_settled=" << (report.coarse_settled ? "True" : "False") << ")";
  return text.str();
}

}  // namespace

void bind_poser(py::module_& m) {
  auto report_class =
      py::class_<Report>(m, "Report", "What the last move, refine or settle of a Poser did.",
                         made_by_the_library())
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
          .def_readonly(
              "converged", &Report::converged,
              "Whether nothing is left to do: with hold a full Newton step is below 1e-5 of the "
              "rest's diameter, with akvf furthest_handle is at most 1e-3 of it; with arap always, but for a "
              "settle that ended before its iterations did.")
          .def_readonly("coarse_settled", &Report::coarse_settled,
                        "With a cage and hold: nothing is left to do on the coarse mesh. Unless converged, "
                        "refine goes on with the mesh itself, which takes longer.")
          .def("__repr__", &report_text);
  report_class.attr("__module__") = "planar_native";

  auto poser_class = py::class_<SharedPoser, PoserRef>(
      m, "Poser",
      R"(Poser(rest, triangles, *, method="hold", pin_weight=None, stiffness=None, cage=None, progress=None)

Poses a mesh by moving handles. The object keeps the posed shape from one move to the next.

rest n x 2, triangles m x 3. method "hold" looks for the least distortion of the rest shape, sum over the triangles of
stiffness area (|J|^2 + |1/J|^2) (symmetric Dirichlet, J from rest to pose) plus pin_weight times the squared distances of the
handles from their targets, by projected Newton steps in which no triangle inverts. The pose it settles in does not depend on
the path, except where there are several (an arm wound the other way round). Method "akvf" is the as-Killing-as-possible deformation
[AKVF 7, 8, 14-16], in substeps in which no triangle inverts, at most 32 in a move; it forgets the rest shape and departs from
the paper where patches turn and where triangles are squeezed (planar/poser.h says how). Method "arap" is arap_two_step with
cotangent weights: a move gives its whole result, which depends on the handles alone; settle goes on by local/global iterations
with a rotation a triangle; triangles may turn over. pin_weight has no unit (None: 1000);
with akvf it is the lambda squared of [AKVF 7]. stiffness is a positive factor per triangle, m.

cage, 12 at least, is about how many vertices a coarse mesh has that is solved on in place of a larger one, which is carried
along; handles, positions and report are those of the mesh itself. None solves on the mesh. With hold and up to 150000 vertices,
refine and settle end with steps on the mesh itself. progress(share) is called while the coarse mesh is made; it answers True,
False or None, and False raises Cancelled.

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
           py::arg("method") = "hold", py::arg("pin_weight") = py::none(), py::arg("stiffness") = py::none(),
           py::arg("cage") = py::none(), py::arg("progress") = py::none())
      .def("set_handles", &py_set_handles, py::arg("handles"), py::kw_only(), py::arg("weights") = py::none(),
           py::arg("groups") = py::none(), R"(set_handles(handles, *, weights=None, groups=None)

Replaces the handles. The shape stays as it is.

handles k (see the module); weights k, positive, multiply pin_weight (None: 1 each); groups k integers: handles of one group
(a patch) share the weight of one pin (None: each handle is its own group). Raises ValueError.)")
      .def("set_joints", &py_set_joints, py::arg("first"), py::arg("second"), py::kw_only(),
           py::arg("strength") = py::none(), R"(set_joints(first, second, *, strength=None)

Replaces the joints of method "hold": pairs of points of different parts that hang together. The shape stays as it is, targets
are forgotten.

first and second k handles each (see the module); strength k, positive, multiply the weight of a joint (None: 1 each). Parts that
hang on one with handles come along; how hinges turn that nothing else decides is as if all moved as one. Raises ValueError and
SolveError; the joints are then those before the call.)")
      .def("move", &py_move, py::arg("targets"), R"(move(targets)

A bounded number of steps towards targets, k x 2, from the present shape; for each event of a drag. Returns the new positions,
n x 2. Raises ValueError and SolveError; the shape is then the one before the call.)")
      .def(
          "refine",
          [](const PoserRef& poser, py::handle progress) {
            const std::function<bool(double)> asked = to_progress(progress);
            return poser->poser.with([&asked](Poser& p) { return p.refine(asked); });
          },
          py::kw_only(), py::arg("progress") = py::none(), R"(refine(*, progress=None)

One more bounded piece of work towards the last targets, about as much as a move, in which no vertex moves by more than 2 % of
the rest's diameter; for the frames after the mouse has come to rest, until report.converged. Without targets it does
nothing. Where a mesh with a cage is solved itself, progress(share) is called all the time; it answers True, False or None, and
False raises Cancelled. Returns the new positions, n x 2. Raises SolveError and Cancelled; the shape is then the one before the
call.)")
      .def(
          "settle",
          [](const PoserRef& poser, py::handle progress) {
            const std::function<bool(double)> asked = to_progress(progress);
            return poser->poser.with([&asked](Poser& p) { return p.settle(asked); });
          },
          py::kw_only(), py::arg("progress") = py::none(), R"(settle(*, progress=None)

All that is left to do towards the last targets, within a fixed number of steps; without refine's limit on motion. Without
targets it does nothing. progress is that of refine. Returns the new positions, n x 2. Raises SolveError and Cancelled; the
shape is then the one before the call.)")
      .def("reset", &py_reset, py::arg("positions") = py::none(), R"(reset(positions=None)

Takes positions, n x 2, as the present shape; None takes the rest shape. Handles stay, targets are forgotten. Raises ValueError.)")
      .def_property_readonly("positions", py::cpp_function([](const PoserRef& poser) {
                               return poser->poser.with([](const Poser& p) { return p.positions(); });
                             }),
                             "The present shape, n x 2; a copy.")
      .def_property_readonly("report", py::cpp_function([](const PoserRef& poser) {
                               return poser->poser.with([](const Poser& p) { return p.report(); });
                             }),
                             "What the last move, refine or settle did, a Report.");
}

}  // namespace planar::python
