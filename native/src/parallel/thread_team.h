// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "parallel/worker.h"

namespace planar {

/// Threads that share out numbered tasks. Which thread does a task is left to chance, so a task must not
/// care.
class ThreadTeam {
 public:
  /// \param threads the caller's among them; 0: one per core, at most 8
  explicit ThreadTeam(int threads);

  int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls task(i, thread) for each i in 0..count-1 and thread in 0..size()-1, one call at a time in a
  /// thread. Throws what one of them threw, when all threads have stopped.
  void run(std::size_t count, const std::function<void(std::size_t, std::size_t)>& task);

 private:
  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace planar
