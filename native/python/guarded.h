// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <mutex>
#include <utility>

namespace planar::python {

// An object of the library that Python threads may share. The library allows one thread at a time; Python
// code without the GIL could break that by accident, so uses of one object wait for each other. They do so
// without the GIL: a thread that held it while waiting would stop the thread it waits for.
template <typename Object>
class Guarded {
 public:
  explicit Guarded(Object object) : object_(std::move(object)) {}

  // What use(object) gives, copied where that is a reference. To be called with the GIL; `use` runs without.
  template <typename Use>
  auto with(const Use& use) {
    const pybind11::gil_scoped_release unlocked;
    const std::scoped_lock lock(mutex_);
    return use(object_);
  }

 private:
  std::mutex mutex_;
  Object object_;
};

}  // namespace planar::python
