// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "choices.h"
#include "guarded.h"
#include "planar/flatten.h"
#include "progress.h"

namespace py = pybind11;

namespace planar::python {
namespace {

// What flatten and Flattener are given in common.
struct Request {
  Request(py::handle vertices_, py::handle triangles_, const std::string& method, int iterations,
          const std::string& weights, py::handle fixed, std::optional<double> pin_weight, py::handle progress)
      : vertices(to_coordinates("vertices", vertices_, kAnyRows, 3)), triangles(to_triangles(triangles_)) {
    options.method = to_choice<FlattenMethod>(
        "method", method, {{"hold", FlattenMethod::hold}, {"two_step", FlattenMethod::two_steps}});
    options.iterations = iterations;
    options.weights = to_arap_weights(weights);
    if (!fixed.is_none()) {
      const Eigen::VectorXi ends = to_indices("fixed", fixed, 2);
      options.fixed = {ends[0], ends[1]};
    }
    if (pin_weight) options.pin_weight = *pin_weight;
    options.progress = to_progress(progress);
  }

  SpacePoints vertices;
  Triangles triangles;
  FlattenOptions options;
};

Points py_flatten(py::handle vertices, py::handle triangles, const std::string& method, int iterations,
                  const std::string& weights, py::handle fixed, py::handle progress) {
  const Request request(vertices, triangles, method, iterations, weights, fixed, {}, progress);
  const py::gil_scoped_release unlocked;
  return flatten(request.vertices, request.triangles, request.options);
}

// What pins inside triangles are read against never changes, hence needs no lock.
struct SharedFlattener {
  explicit SharedFlattener(const Request& request)
      : triangles(request.triangles),
        n_vertices(request.vertices.rows()),
        flattener(Flattener(request.vertices, request.triangles, request.options)) {}

  Triangles triangles;
  Eigen::Index n_vertices;
  Guarded<Flattener> flattener;
};

// Asked for the holder, pybind11 notices an object that was made by __new__ alone.
using FlattenerRef = std::shared_ptr<SharedFlattener>;

FlattenerRef make_flattener(py::handle vertices, py::handle triangles, const std::string& method,
                            int iterations, const std::string& weights, py::handle fixed,
                            std::optional<double> pin_weight, py::handle progress) {
  const Request request(vertices, triangles, method, iterations, weights, fixed, pin_weight, progress);
  const py::gil_scoped_release unlocked;
  return std::make_shared<SharedFlattener>(request);
}

// A sequence of (vertices, point, direction).
std::vector<HeldLine> to_lines(py::handle value) {
  if (!is_sequence(value))
    throw std::invalid_argument("lines: expected a list of (vertices, point, direction)");
  std::vector<HeldLine> lines;
  for (const py::handle item : items_of(value)) {
    const std::string name = "lines[" + std::to_string(lines.size()) + "]";
    const py::list parts = is_sequence(item) ? items_of(item) : py::list();
    if (parts.size() != 3) throw std::invalid_argument(name + ": expected (vertices, point, direction)");
    lines.push_back({to_indices(name + " vertices", parts[0]), to_numbers(name + " point", parts[1], 2),
                     to_numbers(name + " direction", parts[2], 2)});
  }
  return lines;
}

void py_set_pins(const FlattenerRef& shared, py::handle handles, py::handle weights, py::handle lines) {
  Handles pins = to_handles(handles, shared->triangles, shared->n_vertices);
  const Eigen::VectorXd w = to_numbers("weights", weights, pins.size());
  std::vector<HeldLine> held = to_lines(lines);
  shared->flattener.with([&](Flattener& f) { f.set_pins(std::move(pins), std::move(held), w); });
}

py::tuple py_fitted_line(const FlattenerRef& shared, py::handle vertices) {
  const Eigen::VectorXi v = to_indices("vertices", vertices);
  const HeldLine line = shared->flattener.with([&v](const Flattener& f) { return f.fitted_line(v); });
  return py::make_tuple(line.vertices, Eigen::VectorXd(line.point), Eigen::VectorXd(line.direction));
}

Points py_move(const FlattenerRef& shared, py::handle targets) {
  const Points u = to_points("targets", targets);
  return shared->flattener.with([&u](Flattener& f) { return f.move(u); });
}

}  // namespace

void bind_flatten(py::module_& m) {
  m.def(
      "flatten", &py_flatten, py::arg("vertices"), py::arg("triangles"), py::kw_only(),
      py::arg("method") = "hold", py::arg("iterations") = 0, py::arg("weights") = "cotangent",
      py::arg("fixed") = py::none(), py::arg("progress") = py::none(),
      R"(flatten(vertices, triangles, *, method="hold", iterations=0, weights="cotangent", fixed=None, progress=None)

A piece of surface laid flat, true to scale.

vertices n x 3, triangles m x 3, one part with a boundary, holes if need be, but no handles. method "hold" is the flat shape of
least distortion, in which no triangle is turned over: the energy of Poser's "hold", from each triangle laid flat by itself.
"two_step" is [ARAP09, section 7], which is quicker and may turn triangles over. weights of its edges, "cotangent" or
"uniform". iterations: with hold steps at most, 0: until nothing is left to do; with two_step repetitions of the second step.
fixed: two vertices of an edge, from which the two steps start and which lies along the x axis (None: an edge in the middle, and
the result lies along the x axis).

progress(share) is called now and then; it answers True, False or None, and False raises Cancelled.
Returns n x 2, counter-clockwise as seen from outside, the centroid at 0. Raises ValueError (shape, dtype, not finite, out of
range, a surface that cannot be laid flat, with what to do about it), SolveError and Cancelled.)");

  auto flattener_class = py::class_<SharedFlattener, FlattenerRef>(
      m, "Flattener",
      R"(Flattener(vertices, triangles, *, method="hold", iterations=0, weights="cotangent", fixed=None, pin_weight=None, progress=None)

A piece of surface laid flat, and live with pins: it is registered and laid flat once, then moved as a Poser with "hold".

    flattener = Flattener(vertices, triangles)
    flattener.set_pins([0, 12])
    for targets in path:
        flat = flattener.move(targets)
    flat = flattener.settle()

Arguments and errors as flatten; pin_weight is what a squared distance of a pin from its target counts beside the energy (None:
1000). Threads may share an object: calls on it wait for each other.)");
  flattener_class.attr("__module__") = "planar_native";
  const auto call = [](const auto& use) {
    return [use](const FlattenerRef& shared) { return shared->flattener.with(use); };
  };
  flattener_class
      .def(py::init(&make_flattener), py::arg("vertices"), py::arg("triangles"), py::kw_only(),
           py::arg("method") = "hold", py::arg("iterations") = 0, py::arg("weights") = "cotangent",
           py::arg("fixed") = py::none(), py::arg("pin_weight") = py::none(),
           py::arg("progress") = py::none())
      .def("set_pins", &py_set_pins, py::arg("handles"), py::kw_only(), py::arg("weights") = py::none(),
           py::arg("lines") = py::tuple(), R"(set_pins(handles, *, weights=None, lines=())

Replaces all pins and lines. The shape stays as it is.

handles k (see the module); weights k, positive, multiply pin_weight (None: 1 each). lines: (vertices, point, direction) each, of
vertices that are held on a straight line of the plane and go along it as they like. Raises ValueError.)")
      .def("fitted_line", &py_fitted_line, py::arg("vertices"), R"(fitted_line(vertices)

The straight line nearest to vertices as they lie now: (vertices, point, direction), to keep an edge of the surface straight by
set_pins. Raises ValueError.)")
      .def("move", &py_move, py::arg("targets"), R"(move(targets)

A bounded number of steps towards targets, k x 2, from the present shape; for each event of a drag. Returns the new positions,
n x 2. Raises ValueError and SolveError; the shape is then the one before the call.)")
      .def("refine", call([](Flattener& f) { return f.refine(); }), R"(refine()

One more bounded piece of work towards the last targets, in which no vertex goes far; for the frames after the mouse has come to
rest, until report.converged. Returns the new positions, n x 2. Raises SolveError; the shape is then the one before the call.)")
      .def("settle", call([](Flattener& f) { return f.settle(); }), R"(settle()

All that is left to do towards the last targets, within a fixed number of steps; without pins and lines, back to the least
distortion. Returns the new positions, n x 2. Raises SolveError; the shape is then the one before the call.)")
      .def("reset", call([](Flattener& f) { f.reset(); }), R"(reset()

Back to the shape that it was first laid flat in. Pins and lines stay, and their targets are where they are then.)")
      .def_property_readonly("positions",
                             py::cpp_function(call([](const Flattener& f) { return f.positions(); })),
                             "The present shape, n x 2; a copy.")
      .def_property_readonly(
          "report", py::cpp_function(call([](const Flattener& f) { return f.report(); })),
          "What the last call did, a Report; furthest_handle counts vertices of lines, too.");
}

}  // namespace planar::python
