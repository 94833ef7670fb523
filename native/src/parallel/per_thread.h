// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "parallel/thread_team.h"

namespace planar {

/// What each thread of a team needs for itself, made when it first asks for it.
template <typename Object>
class PerThread {
 public:
  /// \param make called in several threads at once
  PerThread(const ThreadTeam& team, std::function<std::unique_ptr<Object>()> make)
      : make_(std::move(make)), objects_(static_cast<std::size_t>(team.size())) {}

  /// For the task that runs as `thread`.
  Object& of(std::size_t thread) {
    std::unique_ptr<Object>& object = objects_[thread];
    if (!object) object = make_();
    return *object;
  }

 private:
  std::function<std::unique_ptr<Object>()> make_;
  std::vector<std::unique_ptr<Object>> objects_;
};

}  // namespace planar
