// SPDX-License-Identifier: GPL-3.0-or-later
#include "parallel/worker.h"

#ifndef _WIN32
#include <unistd.h>
#endif

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace planar {

namespace {

/// Changes in a fork.
long process_number() {
#ifdef _WIN32
  return 0;
#else
  return getpid();
#endif
}

}  // namespace

/// The thread, and all that it shares with the others.
struct Worker::Thread {
  Thread() : thread(&Thread::run, this) {}

  ~Thread() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    thread.join();
  }

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return busy || stopping; });
      if (!busy) return;
      lock.unlock();
      std::exception_ptr thrown;
      try {
        task();
      } catch (...) {
        thrown = std::current_exception();
      }
      lock.lock();
      failure = thrown;
      busy = false;
      changed.notify_all();
    }
  }

  const long process = process_number();
  std::mutex mutex;
  std::condition_variable changed;
  std::function<void()> task;
  std::exception_ptr failure;
  bool busy = false;
  bool stopping = false;
  std::thread thread;  ///< last, so that it finds the others made
};

Worker::Worker() = default;

Worker::~Worker() { own_thread(); }

/// None if it belongs to the process that this one was forked from. What that one shared with it can neither
/// be used nor destroyed here: both would wait for a thread that is not there.
Worker::Thread* Worker::own_thread() noexcept {
  if (thread_ && thread_->process != process_number()) (void)thread_.release();
  return thread_.get();
}

void Worker::start(std::function<void()> task) {
  if (own_thread() == nullptr) {
    try {
      thread_ = std::make_unique<Thread>();
    } catch (...) {  // no thread, or no memory for one
      try {
        task();
      } catch (...) {
        failure_ = std::current_exception();
      }
      return;
    }
  }
  {
    const std::lock_guard lock(thread_->mutex);
    thread_->task = std::move(task);
    thread_->failure = nullptr;
    thread_->busy = true;
  }
  thread_->changed.notify_all();
}

void Worker::wait() noexcept {
  Thread* thread = own_thread();
  if (thread == nullptr) return;
  std::unique_lock lock(thread->mutex);
  thread->changed.wait(lock, [thread] { return !thread->busy; });
}

bool Worker::wait_for(std::chrono::milliseconds time) noexcept {
  Thread* thread = own_thread();
  if (thread == nullptr) return true;
  std::unique_lock lock(thread->mutex);
  return thread->changed.wait_for(lock, time, [thread] { return !thread->busy; });
}

void Worker::finish() {
  wait();
  if (thread_ && thread_->failure) failure_ = std::exchange(thread_->failure, nullptr);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace planar
