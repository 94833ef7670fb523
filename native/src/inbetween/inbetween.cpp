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

constexpr std::size_t frames_at_a_time = 16;  // between two calls of progress

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
    carrier = CarriedKeys::of(keys, graph, options);
    if (carrier) {
      const std::vector<Ties> ties = ties_of(carrier->graph(), keys, options, carrier.get());
      motion = std::make_unique<Motion>(carrier->keys(),
                                        EdgeGraph(carrier->keys()[0].rows(), carrier->triangles()),
                                        carrier->options(options), ties);
    } else {
      const std::vector<Ties> ties = ties_of(graph, keys, options, nullptr);
      motion = std::make_unique<Motion>(keys, std::move(graph), options, ties);
    }
    reports = motion->report();
    if (!carrier) return;
    for (TransitionReport& report : reports) report.unrepaired = carrier->parts(report.unrepaired);
  }

  std::vector<Points> sample(const Eigen::VectorXd& wanted, Outside outside,
                             const std::function<bool(double)>& progress = {}) {
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
    for (std::size_t first = 0; first < rows.size(); first += frames_at_a_time) {
      const std::size_t end = std::min(first + frames_at_a_time, rows.size());
      if (progress && !progress(static_cast<double>(first) / static_cast<double>(rows.size()))) {
        throw Cancelled();
      }
      std::vector<Points> solved = motion->sample({moments.begin() + static_cast<std::ptrdiff_t>(first),
                                                   moments.begin() + static_cast<std::ptrdiff_t>(end)});
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
                           const Elements& elements, const InbetweenOptions& options) {
  if (options.method == InbetweenMethod::midpoint) {
    const auto progress_from = [&options](double begin) -> std::function<bool(double)> {
      if (!options.progress) return {};
      return [&options, begin](double done) { return options.progress(begin + 0.5 * done); };
    };
    InbetweenOptions solving = options;
    solving.progress = progress_from(0.0);
    return Inbetweens(keys, elements, solving).at(times, Outside::refuse, progress_from(0.5));
  }
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
                                   const std::function<bool(double)>& progress) const {
  return state_->sample(times, outside, progress);
}

const std::vector<TransitionReport>& Inbetweens::report() const { return state_->reports; }

std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Triangles& triangles, const InbetweenOptions& options) {
  return frames(keys, times, triangles, options);
}

std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Edges& edges, const InbetweenOptions& options) {
  return frames(keys, times, edges, options);
}

}  // namespace planar
