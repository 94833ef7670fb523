// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace planar::python {

// Adds in-betweening, transfer of motions and editing of sequences to the module.
void bind_inbetween(pybind11::module_& m);

}  // namespace planar::python
