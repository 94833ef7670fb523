// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include <memory>

#include "arrays.h"
#include "bindings.h"
#include "guarded.h"
#include "planar/harmonic.h"

namespace py = pybind11;

namespace planar::python {
namespace {

struct SharedHarmonic {
  SharedHarmonic(const Points& rest, const Triangles& triangles, const Eigen::VectorXi& held)
      : n_held(held.size()), harmonic(Harmonic(rest, triangles, held)) {}

  Eigen::Index n_held;
  Guarded<Harmonic> harmonic;
};

// Asked for the holder, pybind11 notices an object that was made by __new__ alone.
using HarmonicRef = std::shared_ptr<SharedHarmonic>;

HarmonicRef make_harmonic(py::handle rest, py::handle triangles, py::handle held) {
  const Points x = to_points("rest", rest);
  const Triangles t = to_triangles(triangles);
  const Eigen::VectorXi vertices = to_indices("held", held);
  const py::gil_scoped_release unlocked;
  return std::make_shared<SharedHarmonic>(x, t, vertices);
}

Eigen::VectorXd spread(const HarmonicRef& shared, py::handle values) {
  const Eigen::VectorXd given = to_numbers("values", values, shared->n_held);
  return shared->harmonic.with([&given](const Harmonic& harmonic) { return harmonic.spread(given); });
}

}  // namespace

void bind_harmonic(py::module_& m) {
  py::class_<SharedHarmonic, HarmonicRef>(m, "Harmonic",
                                          R"(Harmonic(rest, triangles, held)

Values of some vertices of a mesh, spread over the others by the discrete harmonic function; factored once.

rest n x 2, triangles m x 3, held k different vertices. Raises ValueError and SolveError.)")
      .def(py::init(&make_harmonic), py::arg("rest"), py::arg("triangles"), py::arg("held"))
      .def("spread", &spread, py::arg("values"),
           R"(spread(values)

The values (n) of all vertices for those (k) of the held ones: none is beyond these; 0 in parts with nothing held.
Raises ValueError.)");
}

}  // namespace planar::python
