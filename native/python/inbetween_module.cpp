// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "choices.h"
#include "guarded.h"
#include "planar/inbetween.h"
#include "progress.h"

namespace py = pybind11;

namespace planar::python {
namespace {

// Indices, or a sequence of indices and None, one a transition.
std::vector<Eigen::VectorXi> to_anchors(py::handle value) {
  if (value.is_none()) return {};
  const py::list items = is_sequence(value) ? items_of(value) : py::list();
  std::vector<Eigen::VectorXi> anchors;
  if (!items.empty() && (items[0].is_none() || is_sequence(items[0]))) {
    for (const py::handle item : items) {
      anchors.push_back(to_indices("anchor[" + std::to_string(anchors.size()) + "]", item));
    }
  } else {
    anchors.push_back(to_indices("anchor", value));
    if (anchors[0].size() == 0) throw std::invalid_argument("anchor: empty, expected vertices or None");
  }
  return anchors;
}

// A sequence of k×2 indices and None, one a transition.
std::vector<Edges> to_joints(py::handle value) {
  if (value.is_none()) return {};
  if (!is_sequence(value)) throw std::invalid_argument("joints: expected a list of (k, 2) arrays and None");
  std::vector<Edges> joints;
  for (const py::handle item : items_of(value)) {
    joints.push_back(item.is_none() ? Edges()
                                    : to_edges("joints[" + std::to_string(joints.size()) + "]", item));
  }
  return joints;
}

// Handles of a mesh.
Handles to_pins(py::handle value, const Elements& elements, Eigen::Index n_vertices) {
  if (value.is_none()) return {};
  const auto* triangles = std::get_if<Triangles>(&elements);
  if (triangles == nullptr)
    throw std::invalid_argument("pins: edges without faces have none; give triangles");
  return to_handles(value, *triangles, n_vertices);
}

InbetweenMethod to_method(const std::string& name) {
  return to_choice<InbetweenMethod>("method", name,
                                    {{"midpoint", InbetweenMethod::midpoint},
                                     {"paper", InbetweenMethod::paper},
                                     {"global", InbetweenMethod::global}});
}

AnchorPath to_path(const std::string& name) {
  return to_choice<AnchorPath>("anchor_path", name,
                               {{"straight", AnchorPath::straight}, {"arc", AnchorPath::arc}});
}

// What inbetween and Inbetweens are given in common.
struct Request {
  Request(py::handle keys_, py::handle triangles, py::handle edges, py::handle key_times, py::handle rest,
          py::handle turns, py::handle anchor, const std::string& anchor_path, py::handle joints,
          py::handle pins, py::handle pin_groups, py::handle pinned, bool smooth, std::optional<int> cage,
          double tolerance, int max_iterations, int threads, py::handle progress)
      : keys(to_shapes("keys", keys_)), elements(to_elements(triangles, edges)) {
    options.key_times = to_numbers("key_times", key_times, static_cast<Eigen::Index>(keys.size()));
    if (!rest.is_none()) options.rest = to_points("rest", rest, vertices_of(keys));
    const auto n_keys = static_cast<Eigen::Index>(keys.size());
    options.turns = to_whole_table("turns", turns, std::max<Eigen::Index>(n_keys - 1, 0));
    options.anchors = to_anchors(anchor);
    options.anchor_path = to_path(anchor_path);
    options.joints = to_joints(joints);
    options.pins = to_pins(pins, elements, vertices_of(keys));
    options.pin_groups = to_indices("pin_groups", pin_groups, options.pins.size());
    options.pinned = to_flag_table("pinned", pinned);
    options.smooth = smooth;
    options.cage = cage;
    options.tolerance = tolerance;
    options.max_iterations = max_iterations;
    options.threads = threads;
    options.progress = to_progress(progress);
  }

  std::vector<Points> keys;
  Elements elements;
  InbetweenOptions options;
};

py::array_t<double> py_inbetween(py::handle keys, py::handle times, py::handle triangles, py::handle edges,
                                 py::handle key_times, py::handle rest, py::handle turns,
                                 const std::string& method, py::handle anchor, const std::string& anchor_path,
                                 py::handle joints, py::handle pins, py::handle pin_groups, py::handle pinned,
                                 py::handle pin_paths, bool smooth, std::optional<int> cage, double tolerance,
                                 int max_iterations, int threads, py::handle progress) {
  Request request(keys, triangles, edges, key_times, rest, turns, anchor, anchor_path, joints, pins,
                  pin_groups, pinned, smooth, cage, tolerance, max_iterations, threads, progress);
  request.options.method = to_method(method);
  const Eigen::VectorXd t = to_numbers("times", times, kAnyRows);
  const std::vector<Points> paths = to_paths("pin_paths", pin_paths);
  std::vector<Points> frames;
  {
    const py::gil_scoped_release unlocked;
    frames = std::visit(
        [&](const auto& elements) { return inbetween(request.keys, t, elements, request.options, paths); },
        request.elements);
  }
  return frames_array(frames, vertices_of(request.keys));
}

struct SharedInbetweens {
  explicit SharedInbetweens(const Request& request)
      : n_vertices(vertices_of(request.keys)),
        motion(std::visit(
            [&](const auto& elements) { return Inbetweens(request.keys, elements, request.options); },
            request.elements)) {}

  Eigen::Index n_vertices;
  Guarded<Inbetweens> motion;
};

// Asked for the holder, pybind11 notices an object that was made by __new__ alone.
using InbetweensRef = std::shared_ptr<SharedInbetweens>;

InbetweensRef make_inbetweens(py::handle keys, py::handle triangles, py::handle edges, py::handle key_times,
                              py::handle rest, py::handle turns, py::handle anchor,
                              const std::string& anchor_path, py::handle joints, py::handle pins,
                              py::handle pin_groups, py::handle pinned, bool smooth, std::optional<int> cage,
                              double tolerance, int max_iterations, int threads, py::handle progress) {
  const Request request(keys, triangles, edges, key_times, rest, turns, anchor, anchor_path, joints, pins,
                        pin_groups, pinned, smooth, cage, tolerance, max_iterations, threads, progress);
  const py::gil_scoped_release unlocked;
  return std::make_shared<SharedInbetweens>(request);
}

py::array_t<double> py_at(const InbetweensRef& shared, py::handle times, bool overshoot,
                          py::handle pin_paths) {
  const Eigen::VectorXd t = to_numbers("times", times, kAnyRows);
  const std::vector<Points> paths = to_paths("pin_paths", pin_paths);
  const Outside outside = overshoot ? Outside::extrapolate : Outside::refuse;
  return frames_array(
      shared->motion.with([&](const Inbetweens& motion) { return motion.at(t, outside, {}, paths); }),
      shared->n_vertices);
}

}  // namespace

void bind_inbetween(py::module_& m) {
  m.def(
      "inbetween", &py_inbetween, py::arg("keys"), py::arg("times"), py::kw_only(),
      py::arg("triangles") = py::none(), py::arg("edges") = py::none(), py::arg("key_times") = py::none(),
      py::arg("rest") = py::none(), py::arg("turns") = py::none(), py::arg("method") = "midpoint",
      py::arg("anchor") = py::none(), py::arg("anchor_path") = "straight", py::arg("joints") = py::none(),
      py::arg("pins") = py::none(), py::arg("pin_groups") = py::none(), py::arg("pinned") = py::none(),
      py::arg("pin_paths") = py::none(), py::arg("smooth") = false, py::arg("cage") = py::none(),
      py::arg("tolerance") = 5e-4, py::arg("max_iterations") = 100, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      R"(inbetween(keys, times, *, triangles=None, edges=None, key_times=None, rest=None, turns=None, method="midpoint", anchor=None, anchor_path="straight", joints=None, pins=None, pin_groups=None, pinned=None, pin_paths=None, smooth=False, cage=None, tolerance=5e-4, max_iterations=100, threads=0, progress=None)

Shapes between key shapes, as isometric as possible [AIAP].

keys K x n x 2, K >= 2; times f, each from the first key's time to the last's; one of triangles m x 3 and edges m x 2 (contours,
open lines, any edge soup). key_times K, ascending (None: 0..K-1). rest n x 2: lengths and box are taken from it, so that what is
between two keys depends on no other (None: from the keys' means). turns: extra whole turns, counter-clockwise: a number, K-1, or
(K-1) x parts. anchor: vertices whose mean, part by part, moves on anchor_path "straight" or "arc" (None: the centroid of each
part), or a list of K-1 such sets and None. joints: K-1 arrays k x 2 or None, of layers that hang together: rows of a vertex of the
carrying part and one of the carried part, which stay next to each other as in the keys. pins: handles k (see the module) that
are held on their ways: straight from key to key, so that what stands in both stands, or on pin_paths f x k x 2, their places at
times (entries that are nan: the pin's own way; at a key's time there is the key). pin_groups k integers: handles of one group are a
patch, which is turned as it goes. pinned (K-1) x k truths: which are held between which keys (None: all). smooth: velocities are continuous at the keys, too; what rests or turns back at a key
does so without overshoot, and what is between two keys then depends on the ones next to them as well. cage, 12 at least: about how many vertices a coarse mesh has that is solved on in place of
a larger one (triangles and method "midpoint" only), which is carried along. tolerance of [AIAP 11], a share of the diagonal of the square that holds the keys however they are turned. The result does not depend on threads (0: one per core).

method "midpoint" solves on a grid that depends on the keys alone and samples it: any times give the same frames. Where triangles
would be flipped though they are not in the keys, the motion between those is tracked so that none is. "paper" and "global" are
the paper's Algorithms 2 and 1, with [AIAP 8] corrected: two keys, uniform times.

progress(share) is called now and then; it answers True, False or None, and False raises Cancelled.
Returns f x n x 2; at a key's time that key, to the bit. Raises ValueError (shape, dtype, not finite, out of range), SolveError and
Cancelled.)");

  auto report_class = py::class_<TransitionReport>(
      m, "TransitionReport", "What became of the way from one key to the next.", made_by_the_library());
  report_class.attr("__module__") = "planar_native";
  report_class.def_readonly("iterations", &TransitionReport::iterations, "of the solution")
      .def_readonly("converged", &TransitionReport::converged,
                    "within max_iterations; tracked frames likewise")
      .def_readonly(
          "unrepaired", &TransitionReport::unrepaired,
          "parts whose triangles lie the other way round in one key than in the other: they flip on the way");

  auto motion_class = py::class_<SharedInbetweens, InbetweensRef>(
      m, "Inbetweens",
      R"(Inbetweens(keys, *, triangles=None, edges=None, key_times=None, rest=None, turns=None, anchor=None, anchor_path="straight", joints=None, pins=None, pin_groups=None, pinned=None, smooth=False, cage=None, tolerance=5e-4, max_iterations=100, threads=0, progress=None)

The motion of inbetween(method="midpoint"), solved once, to be sampled again and again: for a breakdown under the mouse.

Arguments and errors as inbetween. Threads may share an object: calls on it wait for each other.)");
  motion_class.attr("__module__") = "planar_native";
  motion_class
      .def(py::init(&make_inbetweens), py::arg("keys"), py::kw_only(), py::arg("triangles") = py::none(),
           py::arg("edges") = py::none(), py::arg("key_times") = py::none(), py::arg("rest") = py::none(),
           py::arg("turns") = py::none(), py::arg("anchor") = py::none(), py::arg("anchor_path") = "straight",
           py::arg("joints") = py::none(), py::arg("pins") = py::none(), py::arg("pin_groups") = py::none(),
           py::arg("pinned") = py::none(), py::arg("smooth") = false, py::arg("cage") = py::none(),
           py::arg("tolerance") = 5e-4, py::arg("max_iterations") = 100, py::arg("threads") = 0,
           py::arg("progress") = py::none())
      .def("at", &py_at, py::arg("times"), py::kw_only(), py::arg("overshoot") = false,
           py::arg("pin_paths") = py::none(), R"(at(times, *, overshoot=False, pin_paths=None)

The shapes at times, f, in any order. With overshoot they may lie outside of the keys' times, by no more than the outermost two
keys are apart: there the motion goes on with the velocities that it has at the key. pin_paths as inbetween. Returns f x n x 2. Raises ValueError and
SolveError.)")
      .def_property_readonly(
          "report",
          [](const InbetweensRef& shared) {
            return shared->motion.with([](const Inbetweens& motion) { return motion.report(); });
          },
          "K-1 reports on the solution, each a TransitionReport.");
}

}  // namespace planar::python
