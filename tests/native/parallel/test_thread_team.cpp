// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "base/thread_count.h"
#include "parallel/per_thread.h"
#include "parallel/thread_team.h"
#include "planar/build_info.h"
#include "planar/types.h"

namespace planar::testing {
namespace {

TEST(ThreadTeam, DoesEveryTaskOnceAndPassesOnFailures) {
  for (const int threads : {1, 2, 5}) {
    ThreadTeam team(threads);
    EXPECT_EQ(team.size(), threads);
    for (const std::size_t count : {0U, 1U, 3U, 100U}) {
      std::vector<int> done(count);
      team.run(count, [&](std::size_t i, std::size_t thread) {
        EXPECT_LT(thread, static_cast<std::size_t>(threads));
        ++done[i];
      });
      EXPECT_EQ(done, std::vector<int>(count, 1));
    }
    const auto fail = [](std::size_t i, std::size_t) {
      if (i == 2) throw SolveError("no");
    };
    EXPECT_THROW(team.run(50, fail), SolveError);
    EXPECT_NO_THROW(team.run(2, fail));
  }
}

TEST(ThreadTeam, IsNeverLargerThanItMayBe) {
  EXPECT_EQ(ThreadTeam(2'000'000'000).size(), most_threads);
  EXPECT_EQ(ThreadTeam(0).size(), default_threads());
  EXPECT_EQ(build_info().threads, ThreadTeam(0).size());
}

TEST(PerThread, MakesWhatIsAskedForOnce) {
  ThreadTeam team(3);
  int made = 0;
  PerThread<int> numbers(team, [&made] { return std::make_unique<int>(++made); });
  EXPECT_EQ(made, 0);
  EXPECT_EQ(numbers.of(2), 1);
  EXPECT_EQ(numbers.of(0), 2);
  EXPECT_EQ(numbers.of(2), 1);
  EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace planar::testing
