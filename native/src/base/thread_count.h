// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <thread>

namespace planar {

/// Of a solve that may use as many threads as it likes: one per core, at most 8.
inline int default_threads() {
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 8);
}

/// Of any solve: more are not started, whatever is asked for.
constexpr int most_threads = 64;

}  // namespace planar
