// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace planar {

/// One thread that lives as long as the object (a move takes milliseconds, too little to start a thread for)
/// and does one task at a time. It starts with the first task.
class Worker {
 public:
  Worker() = default;
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// \pre the task before was waited for
  /// \throw std::system_error the thread cannot be started
  void start(std::function<void()> task);
  /// Returns when the task has ended; does nothing without one.
  void wait() noexcept;
  /// Waits and throws what the task threw.
  void finish();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> task_;
  std::exception_ptr failure_;
  bool busy_ = false;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace planar
