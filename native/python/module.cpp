// SPDX-License-Identifier: GPL-3.0-or-later
// The module's face: each header of the library has a file that binds it. Arguments are converted in
// arrays.cpp.
#include <pybind11/pybind11.h>

#include "bindings.h"
#include "planar/types.h"

namespace py = pybind11;

PYBIND11_MODULE(_core, m) {
  py::options options;
  options.disable_function_signatures();

  auto solve_error = py::register_exception<planar::SolveError>(m, "SolveError", PyExc_RuntimeError);
  solve_error.attr("__module__") = "planar_native";
  solve_error.doc() = "A numerical failure: the data is valid, but the solve did not succeed.";

  auto cancelled = py::register_exception<planar::Cancelled>(m, "Cancelled", PyExc_RuntimeError);
  cancelled.attr("__module__") = "planar_native";
  cancelled.doc() = "A progress callback returned False.";

  using namespace planar::python;
  bind_akvf(m);
  bind_arap(m);
  bind_log_spiral(m);
  bind_distortion(m);
  bind_poser(m);
  bind_inbetween(m);
  bind_transfer(m);
  bind_sequence_edit(m);
  bind_lattice(m);
  bind_flatten(m);
  bind_harmonic(m);
  bind_cutout(m);
  bind_build_info(m);
}
