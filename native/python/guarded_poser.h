// SPDX-License-Identifier: GPL-3.0-or-later
// A planar::Poser that Python threads may share. The library allows one thread at a time; Python code without
// the GIL could break that by accident, so a lock makes calls on one object wait for each other. Call it
// without the GIL: a thread that held the GIL while waiting for the lock would stop the thread it waits for.
#pragma once

#include <mutex>
#include <utility>

#include "planar/poser.h"

namespace planar::python {

class GuardedPoser {
 public:
  GuardedPoser(Points rest, const Triangles& triangles, const PoserOptions& options)
      : triangles_(triangles), n_vertices_(rest.rows()), poser_(std::move(rest), triangles, options) {}

  // What handles inside triangles are read against; never changes, hence needs no lock.
  const Triangles& triangles() const { return triangles_; }
  Eigen::Index n_vertices() const { return n_vertices_; }

  void set_handles(Handles handles, Eigen::VectorXd weights, Eigen::VectorXi groups) {
    const std::scoped_lock lock(mutex_);
    poser_.set_handles(std::move(handles), std::move(weights), std::move(groups));
  }
  Points move(const Points& targets) {
    const std::scoped_lock lock(mutex_);
    return poser_.move(targets);
  }
  Points refine() {
    const std::scoped_lock lock(mutex_);
    return poser_.refine();
  }
  Points settle() {
    const std::scoped_lock lock(mutex_);
    return poser_.settle();
  }
  void reset() {
    const std::scoped_lock lock(mutex_);
    poser_.reset();
  }
  void reset(const Points& positions) {
    const std::scoped_lock lock(mutex_);
    poser_.reset(positions);
  }
  Points positions() const {
    const std::scoped_lock lock(mutex_);
    return poser_.positions();
  }
  Report report() const {
    const std::scoped_lock lock(mutex_);
    return poser_.report();
  }

 private:
  const Triangles triangles_;
  const Eigen::Index n_vertices_;
  mutable std::mutex mutex_;
  Poser poser_;
};

}  // namespace planar::python
