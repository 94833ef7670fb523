// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween_module.h"

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.h"
#include "planar/inbetween.h"
#include "planar/motion.h"

namespace py = pybind11;

namespace planar::python {
namespace {

using Elements = std::variant<Triangles, Edges>;

Elements to_elements(py::handle triangles, py::handle edges) {
  if (triangles.is_none() == edges.is_none()) {
    throw std::invalid_argument("triangles, edges: give one of the two");
  }
  if (!triangles.is_none()) return to_triangles(triangles);
  return to_edges("edges", edges);
}

// f×n×2, or a sequence of n×2.
std::vector<Points> to_shapes(const std::string& name, py::handle value) {
  if (!py::isinstance<py::sequence>(value) && !py::isinstance<py::array>(value)) {
    throw std::invalid_argument(name + ": expected an array of shapes, (k, n, 2)");
  }
  std::vector<Points> shapes;
  for (const py::handle shape : value) {
    shapes.push_back(to_points(name + "[" + std::to_string(shapes.size()) + "]", shape));
  }
  return shapes;
}

Eigen::MatrixXi to_turns(py::handle value, Eigen::Index n_transitions) {
  if (value.is_none()) return {};
  if (py::isinstance<py::int_>(value)) {
    return Eigen::MatrixXi::Constant(n_transitions, 1, to_indices("turns", py::make_tuple(value))[0]);
  }
  const py::array array = py::array::ensure(value);
  if (!array || (array.ndim() != 1 && array.ndim() != 2)) {
    throw std::invalid_argument("turns: expected a whole number, (K-1) or (K-1, parts) of them");
  }
  if (array.ndim() == 1) return to_indices("turns", value);
  Eigen::MatrixXi turns(array.shape(0), array.shape(1));
  Eigen::Index k = 0;
  for (const py::handle row : value) {
    turns.row(k) = to_indices("turns[" + std::to_string(k) + "]", row, turns.cols()).transpose();
    ++k;
  }
  return turns;
}

bool is_sequence(py::handle value) {
  if (py::isinstance<py::array>(value)) return py::reinterpret_borrow<py::array>(value).ndim() > 0;
  return py::isinstance<py::sequence>(value) && !py::isinstance<py::str>(value);
}

// Indices, or a sequence of indices and None, one a transition.
std::vector<Eigen::VectorXi> to_anchors(py::handle value) {
  if (value.is_none()) return {};
  if (is_sequence(value) && py::len(value) > 0) {
    const py::handle first = *py::iter(value);
    if (first.is_none() || is_sequence(first)) {
      std::vector<Eigen::VectorXi> anchors;
      for (const py::handle item : value) {
        anchors.push_back(to_indices("anchor[" + std::to_string(anchors.size()) + "]", item));
      }
      return anchors;
    }
  }
  return {to_indices("anchor", value)};
}

// A sequence of k×2 indices and None, one a transition.
std::vector<Edges> to_joints(py::handle value) {
  if (value.is_none()) return {};
  if (!is_sequence(value)) throw std::invalid_argument("joints: expected a list of (k, 2) arrays and None");
  std::vector<Edges> joints;
  for (const py::handle item : value) {
    joints.push_back(item.is_none() ? Edges()
                                    : to_edges("joints[" + std::to_string(joints.size()) + "]", item));
  }
  return joints;
}

template <typename Choice>
Choice to_choice(const char* name, const std::string& value, const std::map<std::string, Choice>& choices) {
  const auto found = choices.find(value);
  if (found != choices.end()) return found->second;
  std::ostringstream text;
  text << name << ": '" << value << "' is not available; there are";
  for (const auto& [choice, meaning] : choices) text << " '" << choice << "'";
  throw std::invalid_argument(text.str());
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

std::function<bool(double)> to_progress(const py::object& callback) {
  if (callback.is_none()) return {};
  return [&callback](double share) {
    const py::gil_scoped_acquire locked;
    const py::object answer = callback(share);
    return answer.is_none() || py::cast<bool>(answer);
  };
}

py::array_t<double> to_array(const std::vector<Points>& frames, Eigen::Index n_vertices) {
  py::array_t<double> array(
      {static_cast<py::ssize_t>(frames.size()), static_cast<py::ssize_t>(n_vertices), py::ssize_t{2}});
  double* out = array.mutable_data();
  for (const Points& frame : frames) {
    std::memcpy(out, frame.data(), static_cast<std::size_t>(frame.size()) * sizeof(double));
    out += frame.size();
  }
  return array;
}

Eigen::Index vertices_of(const std::vector<Points>& shapes) { return shapes.empty() ? 0 : shapes[0].rows(); }

// What inbetween and Inbetweens are given in common.
struct Request {
  Request(py::handle keys_, py::handle triangles, py::handle edges, py::handle key_times, py::handle rest,
          py::handle turns, py::handle anchor, const std::string& anchor_path, py::handle joints, bool smooth,
          double tolerance, int max_iterations, int threads, const py::object& progress)
      : keys(to_shapes("keys", keys_)), elements(to_elements(triangles, edges)) {
    options.key_times = to_numbers("key_times", key_times, static_cast<Eigen::Index>(keys.size()));
    if (!rest.is_none()) options.rest = to_points("rest", rest, vertices_of(keys));
    options.turns = to_turns(turns, static_cast<Eigen::Index>(keys.size()) - 1);
    options.anchors = to_anchors(anchor);
    options.anchor_path = to_path(anchor_path);
    options.joints = to_joints(joints);
    options.smooth = smooth;
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
                                 py::handle joints, bool smooth, double tolerance, int max_iterations,
                                 int threads, const py::object& progress) {
  Request request(keys, triangles, edges, key_times, rest, turns, anchor, anchor_path, joints, smooth,
                  tolerance, max_iterations, threads, progress);
  request.options.method = to_method(method);
  const Eigen::VectorXd t = to_numbers("times", times, kAnyRows);
  std::vector<Points> frames;
  {
    const py::gil_scoped_release unlocked;
    frames = std::visit(
        [&](const auto& elements) { return inbetween(request.keys, t, elements, request.options); },
        request.elements);
  }
  return to_array(frames, vertices_of(request.keys));
}

// Threads that share an object wait for each other.
class GuardedInbetweens {
 public:
  explicit GuardedInbetweens(const Request& request)
      : n_vertices_(vertices_of(request.keys)),
        motion_(std::visit(
            [&](const auto& elements) { return Inbetweens(request.keys, elements, request.options); },
            request.elements)) {}

  py::array_t<double> at(py::handle times, bool overshoot) {
    const Eigen::VectorXd t = to_numbers("times", times, kAnyRows);
    std::vector<Points> frames;
    {
      const py::gil_scoped_release unlocked;
      const std::lock_guard lock(mutex_);
      frames = motion_.at(t, overshoot ? Outside::extrapolate : Outside::refuse);
    }
    return to_array(frames, n_vertices_);
  }

 private:
  Eigen::Index n_vertices_;
  std::mutex mutex_;
  Inbetweens motion_;
};

using InbetweensRef = std::shared_ptr<GuardedInbetweens>;

InbetweensRef make_inbetweens(py::handle keys, py::handle triangles, py::handle edges, py::handle key_times,
                              py::handle rest, py::handle turns, py::handle anchor,
                              const std::string& anchor_path, py::handle joints, bool smooth,
                              double tolerance, int max_iterations, int threads, const py::object& progress) {
  const Request request(keys, triangles, edges, key_times, rest, turns, anchor, anchor_path, joints, smooth,
                        tolerance, max_iterations, threads, progress);
  const py::gil_scoped_release unlocked;
  return std::make_shared<GuardedInbetweens>(request);
}

py::array_t<double> py_transfer_motion(py::handle frames, py::handle target, py::handle triangles,
                                       py::handle edges) {
  const std::vector<Points> source = to_shapes("frames", frames);
  const Points shape = to_points("target", target);
  const Elements elements = to_elements(triangles, edges);
  std::vector<Points> result;
  {
    const py::gil_scoped_release unlocked;
    result = std::visit([&](const auto& e) { return transfer_motion(source, shape, e); }, elements);
  }
  return to_array(result, vertices_of(source));
}

py::array_t<double> py_edit_sequence(py::handle frames, const py::dict& edits, py::handle triangles,
                                     py::handle edges) {
  const std::vector<Points> source = to_shapes("frames", frames);
  std::vector<FrameEdit> changes;
  for (const auto& [frame, shape] : edits) {
    if (!py::isinstance<py::int_>(frame))
      throw std::invalid_argument("edits: the keys must be frame numbers");
    const std::string name = "edits[" + py::str(frame).cast<std::string>() + "]";
    changes.push_back({py::cast<int>(frame), to_points(name, shape, vertices_of(source))});
  }
  const Elements elements = to_elements(triangles, edges);
  std::vector<Points> result;
  {
    const py::gil_scoped_release unlocked;
    result = std::visit([&](const auto& e) { return edit_sequence(source, changes, e); }, elements);
  }
  return to_array(result, vertices_of(source));
}

}  // namespace

void bind_inbetween(py::module_& m) {
  auto cancelled = py::register_exception<Cancelled>(m, "Cancelled", PyExc_RuntimeError);
  cancelled.attr("__module__") = "planar_native";
  cancelled.doc() = "A progress callback returned False.";

  m.def(
      "inbetween", &py_inbetween, py::arg("keys"), py::arg("times"), py::kw_only(),
      py::arg("triangles") = py::none(), py::arg("edges") = py::none(), py::arg("key_times") = py::none(),
      py::arg("rest") = py::none(), py::arg("turns") = py::none(), py::arg("method") = "midpoint",
      py::arg("anchor") = py::none(), py::arg("anchor_path") = "straight", py::arg("joints") = py::none(),
      py::arg("smooth") = false, py::arg("tolerance") = 5e-4, py::arg("max_iterations") = 100,
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      R"(inbetween(keys, times, *, triangles=None, edges=None, key_times=None, rest=None, turns=None, method="midpoint", anchor=None, anchor_path="straight", joints=None, smooth=False, tolerance=5e-4, max_iterations=100, threads=0, progress=None)

Shapes between key shapes, as isometric as possible (Li et al. 2013, "Planar shape interpolation using relative velocity
fields").

keys K x n x 2, K >= 2; times f, each from the first key's time to the last's; one of triangles m x 3 and edges m x 2 (contours,
open lines, any edge soup). key_times K, ascending (None: 0..K-1). rest n x 2: lengths and box are taken from it, so that what is
between two keys depends on no other (None: from the keys' means). turns: extra whole turns, counter-clockwise: a number, K-1, or
(K-1) x parts. anchor: vertices whose mean, part by part, moves on anchor_path "straight" or "arc" (None: the centroid of each
part), or a list of K-1 such sets and None. joints: K-1 arrays k x 2 or None, of layers that hang together: rows of a vertex of the
carrying part and one of the carried part, which stay next to each other as in the keys. smooth: velocities are continuous at the keys, too; what rests or turns back at a key
does so without overshoot, and what is between two keys then depends on the ones next to them as well. tolerance of (11), a share of the box diagonal. The result does not depend on threads (0: one per core).

method "midpoint" solves on a grid that depends on the keys alone and samples it: any times give the same frames. Where triangles
would be flipped though they are not in the keys, the motion between those is tracked so that none is. "paper" and "global" are
the paper's Algorithms 2 and 1, with its equation (8) corrected: two keys, uniform times.

progress(share) is called now and then; False from it raises Cancelled.
Returns f x n x 2; at a key's time that key, to the bit. Raises ValueError (shape, dtype, not finite, out of range), SolveError and
Cancelled.)");

  auto motion_class = py::class_<GuardedInbetweens, InbetweensRef>(
      m, "Inbetweens",
      R"(Inbetweens(keys, *, triangles=None, edges=None, key_times=None, rest=None, turns=None, anchor=None, anchor_path="straight", joints=None, smooth=False, tolerance=5e-4, max_iterations=100, threads=0, progress=None)

The motion of inbetween(method="midpoint"), solved once, to be sampled again and again: for a breakdown under the mouse.

Arguments and errors as inbetween. Threads may share an object: calls on it wait for each other.)");
  motion_class.attr("__module__") = "planar_native";
  motion_class
      .def(py::init(&make_inbetweens), py::arg("keys"), py::kw_only(), py::arg("triangles") = py::none(),
           py::arg("edges") = py::none(), py::arg("key_times") = py::none(), py::arg("rest") = py::none(),
           py::arg("turns") = py::none(), py::arg("anchor") = py::none(), py::arg("anchor_path") = "straight",
           py::arg("joints") = py::none(), py::arg("smooth") = false, py::arg("tolerance") = 5e-4,
           py::arg("max_iterations") = 100, py::arg("threads") = 0, py::arg("progress") = py::none())
      .def(
          "at",
          [](const InbetweensRef& motion, py::handle times, bool overshoot) {
            return motion->at(times, overshoot);
          },
          py::arg("times"), py::kw_only(), py::arg("overshoot") = false, R"(at(times, *, overshoot=False)

The shapes at times, f, in any order. With overshoot they may lie outside of the keys' times, by no more than the outermost two
keys are apart: there the motion goes on with the velocities that it has at the key. Returns f x n x 2. Raises ValueError and
SolveError.)");

  m.def("transfer_motion", &py_transfer_motion, py::arg("frames"), py::arg("target"), py::kw_only(),
        py::arg("triangles") = py::none(), py::arg("edges") = py::none(),
        R"(transfer_motion(frames, target, *, triangles=None, edges=None)

The motion of frames, made by another shape of the same connectivity (Li et al. 2013, section 5.1).

frames f x n x 2; target n x 2, the other shape where the source is frames[0]; one of triangles m x 3 and edges m x 2.
Returns f x n x 2, the first of which is target. Raises ValueError and SolveError.)");

  m.def("edit_sequence", &py_edit_sequence, py::arg("frames"), py::arg("edits"), py::kw_only(),
        py::arg("triangles") = py::none(), py::arg("edges") = py::none(),
        R"(edit_sequence(frames, edits, *, triangles=None, edges=None)

Spreads changes of single frames over their sequence (Li et al. 2013, section 5.2).

frames f x n x 2; edits {frame number: n x 2}; one of triangles m x 3 and edges m x 2. With one edit every frame takes it on;
between two it goes evenly from one to the other, so that edits of the first and last frame that change nothing keep them.
Returns f x n x 2, edited frames as given. Raises ValueError and SolveError.)");
}

}  // namespace planar::python
