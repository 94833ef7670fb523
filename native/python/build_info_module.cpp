// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "planar/build_info.h"

namespace py = pybind11;

namespace planar::python {
namespace {

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

}  // namespace

void bind_build_info(py::module_& m) {
  m.def("build_info", &py_build_info, R"(build_info()

How the module was built: version, backend of the sparse solver, the versions of eigen and suitesparse, and the threads a
solve may use.)");
}

}  // namespace planar::python
