// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>

namespace planar {

/// One thread that lives as long as the object (a move takes milliseconds, too little to start a thread for)
/// and does one task at a time. It starts with the first task.
///
/// Where no thread is to be had, start() does the task itself: it takes longer, but nothing fails. In a
/// process that was forked, which has its parent's memory but not its threads, the next task starts a new
/// one; this holds if no task was under way.
class Worker {
 public:
  Worker();
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// \pre the task before was waited for
  void start(std::function<void()> task);
  /// Returns when the task has ended; does nothing without one.
  void wait() noexcept;
  /// The same, but for so long at most; whether the task has ended.
  bool wait_for(std::chrono::milliseconds time) noexcept;
  /// Waits and throws what the task threw.
  void finish();

 private:
  struct Thread;

  Thread* own_thread() noexcept;

  std::unique_ptr<Thread> thread_;
  std::exception_ptr failure_;  ///< of a task done by start()
};

}  // namespace planar
