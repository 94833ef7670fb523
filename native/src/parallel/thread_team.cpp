// SPDX-License-Identifier: GPL-3.0-or-later
#include "parallel/thread_team.h"

#include <algorithm>
#include <atomic>

#include "base/thread_count.h"

namespace planar {

ThreadTeam::ThreadTeam(int threads) {
  threads = threads == 0 ? default_threads() : std::min(threads, most_threads);
  for (int i = 1; i < threads; ++i) workers_.push_back(std::make_unique<Worker>());
}

void ThreadTeam::run(std::size_t count, const std::function<void(std::size_t, std::size_t)>& task) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&](std::size_t thread) {
    try {
      for (std::size_t i = next++; i < count; i = next++) task(i, thread);
    } catch (...) {
      next = count;
      throw;
    }
  };
  const std::size_t helpers = std::min(workers_.size(), count > 0 ? count - 1 : 0);
  std::exception_ptr failure;
  const auto note_failure = [&failure](const auto& call) {
    try {
      call();
    } catch (...) {
      failure = std::current_exception();
    }
  };
  std::size_t started = 0;
  note_failure([&] {
    for (; started < helpers; ++started) {
      workers_[started]->start([&work, thread = started + 1] { work(thread); });
    }
    work(0);
  });
  // All of them use this frame, so all have to end before it does.
  for (std::size_t i = 0; i < started; ++i) note_failure([&] { workers_[i]->finish(); });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace planar
