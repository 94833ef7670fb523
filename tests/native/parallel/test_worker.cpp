// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>

#include "parallel/no_threads.h"
#include "parallel/worker.h"

#ifdef __SANITIZE_THREAD__
/// A forked process starts threads here, which the sanitizer ends by default.
extern "C" const char* __tsan_default_options() { return "die_after_fork=0"; }
#endif

namespace planar::testing {
namespace {

TEST(Worker, DoesTasksInOneOtherThread) {
  Worker worker;
  std::thread::id first, second;
  worker.start([&] { first = std::this_thread::get_id(); });
  worker.finish();
  worker.start([&] { second = std::this_thread::get_id(); });
  worker.finish();
  EXPECT_EQ(first, second);
  EXPECT_NE(first, std::this_thread::get_id());
}

TEST(Worker, IsWaitedForNoLongerThanAsked) {
  Worker worker;
  EXPECT_TRUE(worker.wait_for(std::chrono::milliseconds(0)));
  std::promise<void> gate;
  worker.start([&gate] { gate.get_future().wait(); });
  EXPECT_FALSE(worker.wait_for(std::chrono::milliseconds(1)));
  gate.set_value();
  EXPECT_TRUE(worker.wait_for(std::chrono::minutes(1)));
}

TEST(Worker, PassesExceptionsOnAndGoesOn) {
  Worker worker;
  worker.start([] { throw std::runtime_error("broken"); });
  EXPECT_THROW(worker.finish(), std::runtime_error);
  worker.finish();
  int done = 0;
  worker.start([&] { ++done; });
  worker.finish();
  EXPECT_EQ(done, 1);
}

TEST(Worker, FinishesItsTaskBeforeItEnds) {
  int done = 0;
  {
    Worker worker;
    worker.start([&] { ++done; });
  }
  EXPECT_EQ(done, 1);
}

TEST(Worker, DoesTasksInPlaceWithoutAThreadToBeHad) {
  Worker worker;
  {
    const NoThreads none;
    std::thread::id thread;
    worker.start([&] { thread = std::this_thread::get_id(); });
    worker.finish();
    EXPECT_EQ(thread, std::this_thread::get_id());
    worker.start([] { throw std::runtime_error("broken"); });
    EXPECT_THROW(worker.finish(), std::runtime_error);
  }
  std::thread::id thread;
  worker.start([&] { thread = std::this_thread::get_id(); });
  worker.finish();
  EXPECT_NE(thread, std::this_thread::get_id());
}

#ifndef __SANITIZE_THREAD__  // which ends a forked process that starts a thread
/// What `task` makes of `worker` in a process forked from this one; -1 if that does not end.
int in_a_fork(std::unique_ptr<Worker>& worker, int (*task)(std::unique_ptr<Worker>&)) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    _exit(task(worker));
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Worker, IsUsedAndDroppedAfterAFork) {
  auto worker = std::make_unique<Worker>();
  int done = 0;
  worker->start([&] { ++done; });
  worker->finish();
  const auto use = [](std::unique_ptr<Worker>& own) {
    int result = 0;
    own->start([&] { result = 7; });
    own->finish();
    own->start([&] { ++result; });
    own->finish();
    own.reset();
    return result;
  };
  EXPECT_EQ(in_a_fork(worker, use), 8);
  const auto drop = [](std::unique_ptr<Worker>& own) {
    own->wait();
    own.reset();
    return 9;
  };
  EXPECT_EQ(in_a_fork(worker, drop), 9);
  worker->start([&] { ++done; });
  worker->finish();
  EXPECT_EQ(done, 2);
}
#endif

}  // namespace
}  // namespace planar::testing
