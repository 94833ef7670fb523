// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "linear/sparse_solver.h"
#include "parallel/thread_team.h"
#include "planar/build_info.h"

namespace planar {
namespace {

TEST(BuildInfo, SaysWhatWasBuilt) {
  const BuildInfo info = build_info();
  EXPECT_EQ(info.version, PLANAR_VERSION);
  EXPECT_EQ(default_backend(), Backend::PLANAR_EXPECTED_BACKEND);
  EXPECT_EQ(info.backend,
            default_backend() == Backend::cholmod ? "CHOLMOD supernodal LLT" : "Eigen SimplicialLDLT");
  EXPECT_EQ(info.suitesparse.empty(), default_backend() == Backend::eigen);
  EXPECT_EQ(info.threads, ThreadTeam(0).size());
}

}  // namespace
}  // namespace planar
