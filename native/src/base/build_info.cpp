// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/build_info.h"

#include <Eigen/Core>

#include "base/thread_count.h"

#ifdef PLANAR_CHOLMOD
#include <cholmod.h>
#endif

namespace planar {

namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

BuildInfo build_info() {
  BuildInfo info;
  info.version = PLANAR_VERSION;
  info.eigen = dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
  info.threads = default_threads();
#ifdef PLANAR_CHOLMOD
  info.backend = "CHOLMOD supernodal LLT";
  info.suitesparse = dotted(SUITESPARSE_MAIN_VERSION, SUITESPARSE_SUB_VERSION, SUITESPARSE_SUBSUB_VERSION);
#else
  info.backend = "Eigen SimplicialLDLT";
#endif
  return info;
}

}  // namespace planar
