// SPDX-License-Identifier: GPL-3.0-or-later
// What other threads do where none can start, and after a fork: by functions of Linux and its C library.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "parallel/thread_team.h"
#include "parallel/worker.h"
#include "planar/types.h"

#ifdef __SANITIZE_THREAD__
/// A forked process starts threads here, which the sanitizer ends by default.
extern "C" const char* __tsan_default_options() { return "die_after_fork=0"; }
#endif

namespace planar::testing {
namespace {

/// While it lives no thread can start, as where a process has all the memory or threads that it may have: new
/// ones would get stacks larger than any address space.
class NoThreads {
 public:
  NoThreads() {
    pthread_getattr_default_np(&before_);
    pthread_attr_t huge;
    pthread_getattr_default_np(&huge);
    pthread_attr_setstacksize(&huge, std::size_t{1} << 60U);
    pthread_setattr_default_np(&huge);
    pthread_attr_destroy(&huge);
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);
  }
  ~NoThreads() {
    pthread_setattr_default_np(&before_);
    pthread_attr_destroy(&before_);
  }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;

 private:
  pthread_attr_t before_{};
};

TEST(ThreadTeam, DoesEveryTaskWithoutThreadsToBeHad) {
  const NoThreads none;
  ThreadTeam team(5);
  std::vector<int> done(100);
  team.run(done.size(), [&](std::size_t i, std::size_t) { ++done[i]; });
  EXPECT_EQ(done, std::vector<int>(100, 1));
  const auto fail = [](std::size_t, std::size_t) { throw SolveError("no"); };
  EXPECT_THROW(team.run(50, fail), SolveError);
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
