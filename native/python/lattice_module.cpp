// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "choices.h"
#include "guarded.h"
#include "planar/lattice.h"

namespace py = pybind11;

namespace planar::python {
namespace {

template <typename Number>
py::array_t<Number> copied(const Number* first, Eigen::Index size) {
  return py::array_t<Number>(static_cast<py::ssize_t>(size), first);
}

py::tuple py_lattice_weights(py::handle points, const std::vector<int>& counts,
                             const std::vector<std::string>& kinds, py::handle origin, py::handle spacing) {
  LatticeGrid grid;
  grid.count = counts;
  for (const std::string& kind : kinds) {
    grid.basis.push_back(to_choice<LatticeBasis>("kinds", kind,
                                                 {{"BERNSTEIN", LatticeBasis::bernstein},
                                                  {"LINEAR", LatticeBasis::linear},
                                                  {"CARDINAL", LatticeBasis::cardinal},
                                                  {"CATMULL_ROM", LatticeBasis::catmull_rom},
                                                  {"BSPLINE", LatticeBasis::bspline}}));
  }
  const auto n_axes = static_cast<Eigen::Index>(counts.size());
  grid.origin = to_numbers("origin", origin, n_axes);
  grid.spacing = to_numbers("spacing", spacing, n_axes);
  const Coordinates places = to_coordinates("points", points);
  const LatticeWeights weights = [&] {
    const py::gil_scoped_release unlocked;
    return lattice_weights(places, grid);
  }();
  return py::make_tuple(copied(weights.outerIndexPtr(), weights.rows() + 1),
                        copied(weights.innerIndexPtr(), weights.nonZeros()),
                        copied(weights.valuePtr(), weights.nonZeros()));
}

// What handles are read against never changes, hence needs no lock.
struct SharedLattice {
  SharedLattice(Triangles t, Eigen::Index n, Eigen::Index n_points_, int d, LatticeSolver s)
      : triangles(std::move(t)), n_vertices(n), n_points(n_points_), dimensions(d), solver(std::move(s)) {}

  Triangles triangles;
  Eigen::Index n_vertices, n_points;
  int dimensions;
  Guarded<LatticeSolver> solver;
};

// A LatticeSolver made by __new__ alone holds nothing: asked for the holder pybind11 notices.
using LatticeRef = std::shared_ptr<SharedLattice>;

LatticeRef make_lattice(py::handle rest, py::handle elements, py::handle weights, py::handle lattice_rest,
                        const std::optional<std::string>& method, bool rigid_following,
                        const std::string& edge_weights, double weight_shape,
                        std::optional<double> weight_mesh, std::optional<double> weight_lattice,
                        std::optional<double> weight_rest) {
  LatticeOptions options;
  if (method) {
    options.method = to_choice<LatticeMethodKind>(
        "method", *method, {{"hold", LatticeMethodKind::hold}, {"paper", LatticeMethodKind::paper}});
  }
  options.rigid_following = rigid_following;
  options.edge_weights = to_choice<EdgeWeights>(
      "edge_weights", edge_weights, {{"area", EdgeWeights::area}, {"uniform", EdgeWeights::uniform}});
  // What only the paper's form knows of asks for it.
  const bool printed = !rigid_following || options.edge_weights == EdgeWeights::uniform;
  if (printed && !options.method) options.method = LatticeMethodKind::paper;
  options.weight_shape = weight_shape;
  options.weight_mesh = weight_mesh;
  options.weight_lattice = weight_lattice;
  options.weight_rest = weight_rest;
  const Coordinates x = to_coordinates("rest", rest);
  const int dimensions = static_cast<int>(x.cols());
  auto parts = to_mesh_elements("elements", elements);
  const Coordinates points = to_coordinates("lattice_rest", lattice_rest, kAnyRows, dimensions);
  const LatticeWeights w = to_weights("weights", weights, x.rows(), points.rows());
  const py::gil_scoped_release unlocked;
  LatticeSolver solver(x, parts, w, points, options);
  auto* triangles = std::get_if<Triangles>(&parts);
  return std::make_shared<SharedLattice>(triangles != nullptr ? std::move(*triangles) : Triangles(0, 3),
                                         x.rows(), points.rows(), dimensions, std::move(solver));
}

void py_set_handles(const LatticeRef& shared, py::handle vertices, py::handle lattice_points,
                    py::handle weights, py::handle locked) {
  LatticeHandles handles;
  handles.mesh = vertices.is_none() ? Handles::at_vertices({}, shared->n_vertices)
                                    : to_handles(vertices, shared->triangles, shared->n_vertices);
  handles.weights = to_numbers("weights", weights, handles.mesh.size());
  handles.lattice_points = to_indices("lattice_points", lattice_points);
  handles.locked = to_indices("locked", locked);
  shared->solver.with([&](LatticeSolver& solver) { solver.set_handles(handles); });
}

Coordinates py_solve(const LatticeRef& shared, py::handle vertex_targets, py::handle lattice_targets) {
  const auto read = [&](const char* name, py::handle value) {
    return value.is_none() ? Coordinates(0, shared->dimensions)
                           : to_coordinates(name, value, kAnyRows, shared->dimensions);
  };
  const Coordinates mesh = read("vertex_targets", vertex_targets);
  const Coordinates lattice = read("lattice_targets", lattice_targets);
  return shared->solver.with([&](LatticeSolver& solver) { return solver.solve(mesh, lattice); });
}

void py_reset(const LatticeRef& shared, py::handle points) {
  if (points.is_none()) {
    shared->solver.with([](LatticeSolver& solver) { solver.reset(); });
    return;
  }
  const Coordinates p = to_coordinates("points", points, shared->n_points, shared->dimensions);
  shared->solver.with([&p](LatticeSolver& solver) { solver.reset(p); });
}

std::string report_text(const LatticeReport& report) {
  std::ostringstream text;
  text << "LatticeReport(iterations=" << report.iterations << ", furthest_handle=" << report.furthest_handle
       << ", unreached=" << report.unreached.size() << ", flipped=" << report.flipped
       << ", converged=" << (report.converged ? "True" : "False") << ")";
  return text.str();
}

void bind_report(py::module_& m) {
  auto report_class =
      py::class_<LatticeReport>(m, "LatticeReport",
                                "What the last solve, refine or settle of a LatticeSolver did.",
                                made_by_the_library())
          .def_readonly("iterations", &LatticeReport::iterations,
                        "Newton steps with hold, alternations with paper.")
          .def_readonly("furthest_handle", &LatticeReport::furthest_handle,
                        "Largest distance of a handle, on the mesh or of the lattice, from its target.")
          .def_readonly("handle_distance", &LatticeReport::handle_distance,
                        "That of each handle on the mesh, k.")
          .def_readonly(
              "unreached", &LatticeReport::unreached,
              "Handles on the mesh further than 1e-3 of the diagonal of the rest's box from their "
              "targets. Those that stay so after settle share cells with others; a finer lattice helps.")
          .def_readonly(
              "flipped", &LatticeReport::flipped,
              "Triangles of opposite orientation than at rest, judged on float32-rounded positions; "
              "0 in 3D.")
          .def_readonly(
              "converged", &LatticeReport::converged,
              "Whether nothing is left to do: the last full step moved nothing by more than 1e-6 of "
              "that diagonal. False after a solve that looked at samples only.")
          .def("__repr__", &report_text);
  report_class.attr("__module__") = "planar_native";
}

}  // namespace

void bind_lattice(py::module_& m) {
  m.def("lattice_weights", &py_lattice_weights, py::arg("points"), py::arg("counts"), py::arg("kinds"),
        py::kw_only(), py::arg("origin"), py::arg("spacing"),
        R"(lattice_weights(points, counts, kinds, *, origin, spacing)

Weights with which the points of a regular lattice move places, as Blender's Lattice modifier has them.

points n x 2 or n x 3; counts points an axis, 1 to 64; kinds an axis "LINEAR", "CARDINAL", "CATMULL_ROM", "BSPLINE" (Blender's)
or "BERNSTEIN" [LPFFD 1, 2]; origin the first point, spacing the distance of neighbours. Returns (indptr, indices, values), a
sparse matrix by rows; point (u, v, w) is column u + counts[0] (v + counts[1] w), rows sum to 1. Outside of the grid the
displacement is that of its border. Raises ValueError.)");
  bind_report(m);
  auto lattice_class = py::class_<SharedLattice, LatticeRef>(
      m, "LatticeSolver",
      R"(LatticeSolver(rest, elements, weights, lattice_rest, *, method=None, rigid_following=True, edge_weights="area",
              weight_shape=1.0, weight_mesh=None, weight_lattice=None, weight_rest=None)

Moves the N points P of a lattice such that handles on the mesh that it deforms, and points of its own, go to their targets,
while the mesh keeps its shape. The mesh is at rest + W (P - lattice_rest).

rest n x 2 or n x 3; elements m x 3 triangles or m x 2 edges; weights (indptr, indices, values) of W, n x N, with the factors of
the modifier's strength and vertex groups; lattice_rest N x 2 or N x 3, a regular grid, u fastest. method "hold" (triangles in 2D,
then by default) looks for the least distortion, sum of area (|J|^2 + |1/J|^2), and turns no triangle over. "paper" is [LPFFD 9];
rigid_following lets its rest turn with the model, edge_weights "area" has stretching count by area. rigid_following=False and
edge_weights="uniform" are the paper's, and either alone means method "paper". Weights: shape, handles on the mesh (None: hold
1000, paper 100), points of the lattice (the same), and rest (paper: points to be at rest, 0.01; hold: second differences of the
points' displacements, 0.001).

    solver = LatticeSolver(rest, triangles, lattice_weights(...), lattice_rest)
    solver.set_handles([0, 12])
    for targets in path:
        points = solver.solve(targets)
    points = solver.settle()

Threads may share an object: calls on it wait for each other. Different objects work in parallel.
Raises ValueError (shape, dtype, not finite, index out of range, unknown method, no grid) and SolveError.)");
  lattice_class.attr("__module__") = "planar_native";
  lattice_class
      .def(py::init(&make_lattice), py::arg("rest"), py::arg("elements"), py::arg("weights"),
           py::arg("lattice_rest"), py::kw_only(), py::arg("method") = py::none(),
           py::arg("rigid_following") = true, py::arg("edge_weights") = "area", py::arg("weight_shape") = 1.0,
           py::arg("weight_mesh") = py::none(), py::arg("weight_lattice") = py::none(),
           py::arg("weight_rest") = py::none())
      .def("set_handles", &py_set_handles, py::arg("vertices") = py::none(),
           py::arg("lattice_points") = py::none(), py::kw_only(), py::arg("weights") = py::none(),
           py::arg("locked") = py::none(),
           R"(set_handles(vertices=None, lattice_points=None, *, weights=None, locked=None)

Replaces the handles. The shape stays as it is.

vertices k handles on the mesh (see the module); lattice_points numbers of points that are dragged; weights k, positive,
multiply weight_mesh; locked numbers of points that stay where they are, to the bit. Raises ValueError and SolveError.)")
      .def("solve", &py_solve, py::arg("vertex_targets") = py::none(),
           py::arg("lattice_targets") = py::none(),
           R"(solve(vertex_targets=None, lattice_targets=None)

Some steps towards targets, of the handles on the mesh and of the lattice's points, from the present shape; for each event of a
drag. On large meshes it looks at samples only. Returns the lattice's points, N x 2 or N x 3. Raises ValueError and SolveError;
the shape is then the one before the call.)")
      .def(
          "refine",
          [](const LatticeRef& lattice) {
            return lattice->solver.with([](LatticeSolver& s) { return s.refine(); });
          },
          R"(refine()

A few exact steps towards the last targets; for the frames after the mouse has come to rest, until report.converged. Without
targets it does nothing. Returns the lattice's points. Raises SolveError; the shape is then the one before the call.)")
      .def(
          "settle",
          [](const LatticeRef& lattice) {
            return lattice->solver.with([](LatticeSolver& s) { return s.settle(); });
          },
          R"(settle()

All that is left to do towards the last targets, exactly, within a fixed number of steps. Without targets it does nothing.
Returns the lattice's points. Raises SolveError; the shape is then the one before the call.)")
      .def("reset", &py_reset, py::arg("points") = py::none(), R"(reset(points=None)

Takes points, N x 2 or N x 3, as where the lattice is; None takes lattice_rest. Handles stay, targets are forgotten. Raises
ValueError.)")
      .def_property_readonly("points", py::cpp_function([](const LatticeRef& lattice) {
                               return lattice->solver.with([](const LatticeSolver& s) { return s.points(); });
                             }),
                             "The lattice's points, N x 2 or N x 3; a copy.")
      .def_property_readonly(
          "positions", py::cpp_function([](const LatticeRef& lattice) {
            return lattice->solver.with([](const LatticeSolver& s) { return s.positions(); });
          }),
          "The mesh, n x 2 or n x 3; a copy.")
      .def_property_readonly("report", py::cpp_function([](const LatticeRef& lattice) {
                               return lattice->solver.with([](const LatticeSolver& s) { return s.report(); });
                             }),
                             "What the last solve, refine or settle did, a LatticeReport.");
}

}  // namespace planar::python
