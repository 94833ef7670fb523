// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <stdexcept>
#include <string>

namespace planar::python {

// To be used in the call that was given the callback, which keeps it alive.
inline std::function<bool(double)> to_progress(pybind11::handle callback) {
  if (callback.is_none()) return {};
  return [callback](double share) {
    const pybind11::gil_scoped_acquire locked;
    const pybind11::object answer = callback(share);
    if (answer.is_none()) return true;
    pybind11::detail::make_caster<bool> truth;
    if (!truth.load(answer, false)) {
      throw std::invalid_argument("progress: returned " + pybind11::repr(answer).cast<std::string>() +
                                  ", expected True, False or None");
    }
    return pybind11::detail::cast_op<bool>(truth);
  };
}

}  // namespace planar::python
