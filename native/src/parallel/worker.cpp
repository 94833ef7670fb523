// SPDX-License-Identifier: GPL-3.0-or-later
#include "parallel/worker.h"

#include <utility>

namespace planar {

Worker::~Worker() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::start(std::function<void()> task) {
  if (!thread_.joinable()) thread_ = std::thread(&Worker::run, this);
  {
    const std::lock_guard lock(mutex_);
    task_ = std::move(task);
    failure_ = nullptr;
    busy_ = true;
  }
  changed_.notify_all();
}

void Worker::wait() noexcept {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !busy_; });
}

void Worker::finish() {
  wait();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Worker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return busy_ || stopping_; });
    if (!busy_) return;
    lock.unlock();
    std::exception_ptr failure;
    try {
      task_();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = failure;
    busy_ = false;
    changed_.notify_all();
  }
}

}  // namespace planar
