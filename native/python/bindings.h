// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace planar::python {

// Each adds what one of the library's headers offers.
void bind_akvf(pybind11::module_& m);
void bind_arap(pybind11::module_& m);
void bind_build_info(pybind11::module_& m);
void bind_cutout(pybind11::module_& m);
void bind_distortion(pybind11::module_& m);
void bind_flatten(pybind11::module_& m);
void bind_harmonic(pybind11::module_& m);
void bind_inbetween(pybind11::module_& m);
void bind_lattice(pybind11::module_& m);
void bind_log_spiral(pybind11::module_& m);
void bind_poser(pybind11::module_& m);
void bind_sequence_edit(pybind11::module_& m);
void bind_transfer(pybind11::module_& m);

// For results, which only the library makes: pybind11 would give a class's __new__ memory that nobody has
// filled in.
inline pybind11::custom_type_setup made_by_the_library() {
  return pybind11::custom_type_setup([](PyHeapTypeObject* type) {
    type->ht_type.tp_new = [](PyTypeObject* self, PyObject*, PyObject*) -> PyObject* {
      PyErr_Format(PyExc_TypeError, "%s: only the library makes these", self->tp_name);
      return nullptr;
    };
  });
}

}  // namespace planar::python
