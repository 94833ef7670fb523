// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "parallel/worker.h"

namespace planar {

/// Threads that share out numbered tasks. Which thread does a task is left to chance, so a task must not
/// care. They start with the first tasks; where one cannot, the others do its share.
class ThreadTeam {
 public:
  /// \param threads the caller's among them; 0: default_threads(); at most most_threads
  explicit ThreadTeam(int threads);

  int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls task(i, thread) for each i in 0..count-1 and thread in 0..size()-1, one call at a time in a
  /// thread. Throws what one of them threw, when all threads have stopped.
  void run(std::size_t count, const std::function<void(std::size_t, std::size_t)>& task);

  /// Calls task(i) for each i in 0..count-1, `at_a_time` of them in a thread in a row: for tasks that are too
  /// short to be handed out one by one.
  template <typename Task>
  void run_blocks(std::ptrdiff_t count, std::ptrdiff_t at_a_time, const Task& task) {
    run(static_cast<std::size_t>((count + at_a_time - 1) / at_a_time), [&](std::size_t block, std::size_t) {
      const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(block) * at_a_time;
      for (std::ptrdiff_t i = first; i < std::min(first + at_a_time, count); ++i) task(i);
    });
  }

 private:
  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace planar
