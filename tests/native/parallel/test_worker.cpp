// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <stdexcept>
#include <thread>

#include "parallel/worker.h"

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

}  // namespace
}  // namespace planar::testing
