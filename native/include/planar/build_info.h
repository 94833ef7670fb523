// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace planar {

struct BuildInfo {
  std::string version;      ///< of this library
  std::string backend;      ///< sparse factorization: "CHOLMOD supernodal LLT" or "Eigen SimplicialLDLT"
  std::string eigen;        ///< version
  std::string suitesparse;  ///< version, empty without CHOLMOD
  int threads;              ///< that a solve shares its work out to, unless told otherwise
};

BuildInfo build_info();

}  // namespace planar
