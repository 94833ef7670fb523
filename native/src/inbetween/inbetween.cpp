// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/inbetween.h"

#include <algorithm>
#include <string>

#include "base/checks.h"
#include "inbetween/carried_keys.h"
#include "inbetween/inbetween_input.h"
#include "inbetween/motion.h"
#include "inbetween/paper_inbetween.h"

namespace planar {

namespace {

std::vector<Ties> ties_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                          const InbetweenOptions& options, const CarriedKeys* carrier) {
  const std::vector<Eigen::VectorXi> anchors = anchors_of(graph, keys, options);
  const std::vector<Edges> joints = joints_of(graph, keys, options);
  std::vector<Ties> result;
  for (std::size_t k = 0; k < anchors.size(); ++k)
    result.push_back(carrier ? carrier->ties(anchors[k], joints[k]) : Ties(anchors[k], joints[k]));
  return result;
}

}  // namespace

struct Inbetweens::State {
  State(const std::vector<Points>& shapes, EdgeGraph graph, const InbetweenOptions& options) : keys(shapes) {
    require_iteration(options);
    if (options.method != InbetweenMethod::midpoint) {
      throw std::invalid_argument("method: only midpoint can be sampled at any time");
    }
    std::unique_ptr<FramePins> pins;
    if (options.pins.size() > 0) pins = std::make_unique<FramePins>(graph, keys, options);
    carrier = CarriedKeys::of(keys, graph, options, pins.get());
    const EdgeGraph& own = carrier ? carrier->graph() : graph;
    const std::vector<Ties> ties = ties_of(own, keys, options, carrier.get());
    if (carrier) {
      if (pins) carrier->carry(*pins);
      motion = std::make_unique<Motion>(carrier->keys(),
                                        EdgeGraph(carrier->keys()[0].rows(), carrier->triangles()),
                                        carrier->options(options), ties, std::move(pins));
    } else {
      motion = std::make_unique<Motion>(keys, std::move(graph), options, ties, std::move(pins));
    }
    reports = motion->report();
    if (!carrier) return;
    for (TransitionReport& report : reports) report.unrepaired = carrier->parts(report.unrepaired);
  }

  void require_paths(const std::vector<Points>& paths, Eigen::Index n_times) const {
    if (paths.empty()) return;
    if (motion->pin_handles() == 0) throw std::invalid_argument("pin_paths: there are no pins");
    require_rows("pin_paths", static_cast<Eigen::Index>(paths.size()), n_times, "time");
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const std::string name = "pin_paths[" + std::to_string(i) + "]";
      require_rows(name.c_str(), paths[i].rows(), motion->pin_handles(), "handle of pins");
      for (Eigen::Index row = 0; row < paths[i].rows(); ++row) {
        if (paths[i].row(row).hasNaN() || paths[i].row(row).allFinite()) continue;
        throw std::invalid_argument(row_of(name.c_str(), row) + "not a finite number");
      }
    }
  }

  std::vector<Points> sample(const Eigen::VectorXd& wanted, Outside outside,
                             const std::function<bool(double)>& progress = {},
                             const std::vector<Points>& paths = {}) {
    require_paths(paths, wanted.size());
    const Eigen::VectorXd& times = motion->key_times();
    std::vector<Points> result(static_cast<std::size_t>(wanted.size()));
    std::vector<std::size_t> rows;  // those that are not keys
    std::vector<Moment> moments;
    for (Eigen::Index i = 0; i < wanted.size(); ++i) {
      const double time = wanted[i];
      const auto row = static_cast<std::size_t>(i);
      const auto* after = std::upper_bound(times.data(), times.data() + times.size(), time);
      const Eigen::Index before = std::clamp<Eigen::Index>(after - times.data() - 1, 0, times.size() - 1);
      if (time == times[before]) {
        result[row] = keys[static_cast<std::size_t>(before)];
        continue;
      }
      const Eigen::Index transition = std::min(before, times.size() - 2);
      const double share = (time - times[transition]) / (times[transition + 1] - times[transition]);
      const double margin = outside == Outside::extrapolate ? 1.0 : 0.0;
      if (!(share >= -margin && share <= 1.0 + margin)) {
        throw std::invalid_argument(row_of("times", i) + "outside of the keys' times" +
                                    (margin > 0.0 ? " by more than the outermost two are apart" : ""));
      }
      rows.push_back(row);
      moments.push_back({static_cast<std::size_t>(transition), share});
    }
    const std::size_t at_a_time = motion->frames_at_a_time();
    for (std::size_t first = 0; first < rows.size(); first += at_a_time) {
      const std::size_t end = std::min(first + at_a_time, rows.size());
      if (progress && !progress(static_cast<double>(first) / static_cast<double>(rows.size()))) {
        throw Cancelled();
      }
      std::vector<Points> solved =
          motion->sample({moments.begin() + static_cast<std::ptrdiff_t>(first),
                          moments.begin() + static_cast<std::ptrdiff_t>(end)},
                         [&](std::size_t i) { return paths.empty() ? nullptr : &paths[rows[first + i]]; });
      motion->threads().run(end - first, [&](std::size_t i, std::size_t) {
        const auto [k, u] = moments[first + i];
        Points& frame = result[rows[first + i]];
        frame = carrier ? carrier->carried(solved[i], k, u) : std::move(solved[i]);
      });
    }
    return result;
  }

  std::vector<Points> keys;
  std::unique_ptr<CarriedKeys> carrier;  ///< none where the keys themselves are solved
  std::unique_ptr<Motion> motion;
  std::vector<TransitionReport> reports;  ///< on parts of the keys' mesh
};

namespace {

template <typename Elements>
EdgeGraph graph_of(const std::vector<Points>& keys, const Elements& elements) {
  require_keys(keys);
  return EdgeGraph(keys[0].rows(), elements);
}

template <typename Elements>
std::vector<Points> frames(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                           const Elements& elements, const InbetweenOptions& options,
                           const std::vector<Points>& pin_paths) {
  if (options.method == InbetweenMethod::midpoint) {
    const auto progress_from = [&options](double begin) -> std::function<bool(double)> {
      if (!options.progress) return {};
      return [&options, begin](double done) { return options.progress(begin + 0.5 * done); };
    };
    InbetweenOptions solving = options;
    solving.progress = progress_from(0.0);
    return Inbetweens(keys, elements, solving).at(times, Outside::refuse, progress_from(0.5), pin_paths);
  }
  if (!pin_paths.empty()) throw std::invalid_argument("pin_paths: there are no pins");
  return paper_inbetween(keys, times, graph_of(keys, elements), options);
}

}  // namespace

Inbetweens::Inbetweens(const std::vector<Points>& keys, const Triangles& triangles,
                       const InbetweenOptions& options)
    : state_(std::make_unique<State>(keys, graph_of(keys, triangles), options)) {}

Inbetweens::Inbetweens(const std::vector<Points>& keys, const Edges& edges, const InbetweenOptions& options)
    : state_(std::make_unique<State>(keys, graph_of(keys, edges), options)) {}

Inbetweens::Inbetweens(Inbetweens&&) noexcept = default;
Inbetweens& Inbetweens::operator=(Inbetweens&&) noexcept = default;
Inbetweens::~Inbetweens() = default;

Points Inbetweens::at(double time, Outside outside) const {
  return state_->sample(Eigen::VectorXd::Constant(1, time), outside).front();
}

std::vector<Points> Inbetweens::at(const Eigen::VectorXd& times, Outside outside,
                                   const std::function<bool(double)>& progress,
                                   const std::vector<Points>& pin_paths) const {
  return state_->sample(times, outside, progress, pin_paths);
}

const std::vector<TransitionReport>& Inbetweens::report() const { return state_->reports; }

std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Triangles& triangles, const InbetweenOptions& options,
                              const std::vector<Points>& pin_paths) {
  return frames(keys, times, triangles, options, pin_paths);
}

std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Edges& edges, const InbetweenOptions& options,
                              const std::vector<Points>& pin_paths) {
  return frames(keys, times, edges, options, pin_paths);
}

}  // namespace planar
