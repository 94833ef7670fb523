// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/inbetween.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/checks.h"
#include "base/diameter.h"
#include "inbetween/edge_turns.h"
#include "inbetween/flip_repair.h"
#include "inbetween/inbetween_input.h"
#include "inbetween/midpoint_transition.h"
#include "inbetween/paper_inbetween.h"
#include "inbetween/part_placer.h"
#include "inbetween/pinned_transition.h"
#include "parallel/thread_team.h"

namespace planar {

namespace {

constexpr std::size_t frames_at_a_time = 16;  // between two calls of progress

}  // namespace

struct Inbetweens::State {
  /// What moves from keys[k] to keys[k+1].
  struct Transition {
    MidpointTransition edges;
    PartPlacer placer;
    std::unique_ptr<FlipRepair> repair;      ///< none if there is nothing to repair
    std::unique_ptr<PinnedTransition> pins;  ///< none if there are no pins
  };

  State(const std::vector<Points>& shapes, EdgeGraph edge_graph, const InbetweenOptions& options)
      : keys(shapes),
        times(key_times_of(keys, options)),
        graph(std::move(edge_graph)),
        assembler(graph),
        team(options.threads) {
    require_iteration(options);
    if (options.method != InbetweenMethod::midpoint) {
      throw std::invalid_argument("method: only midpoint can be sampled at any time");
    }
    const std::vector<Eigen::VectorXi> anchors = anchors_of(graph, keys, options);
    const std::vector<Edges> joints = joints_of(graph, keys, options);
    const Eigen::MatrixXi extra = turns_of(graph, keys, options);
    const std::vector<Points> references = references_of(keys, options);
    const double tolerance = options.tolerance * size_of(references);
    if (options.pins.size() > 0) pins = std::make_unique<FramePins>(graph, keys, options);
    assembler.factorize(frozen_weights(graph, references));
    const EdgeTurns unwrapped(graph);
    transitions.reserve(anchors.size());
    for (std::size_t k = 0; k < anchors.size(); ++k) {
      const Points &from = keys[k], &to = keys[k + 1];
      const Eigen::VectorXd turns = unwrapped.between(from, to);
      const Eigen::VectorXd part_turns = mean_turns(graph, turns, from, to);
      PartPlacer::Course course{part_turns, Eigen::VectorXd::Zero(graph.n_parts)};
      // Extra turns are about the anchor; on its arc they would be orbits.
      if (options.anchor_path == AnchorPath::arc) course.arc_turns = PartPlacer::arcs(part_turns);
      course.turns +=
          2.0 * std::numbers::pi * extra.row(static_cast<Eigen::Index>(k)).transpose().cast<double>();
      const MidpointTransition::Settings settings{tolerance, options.max_iterations,
                                                  progress_of(options, 0.0, k)};
      settings.progress(0.0);
      transitions.push_back({{graph, assembler, from, to, turns, part_turns, settings, team},
                             {graph, from, to, anchors[k], joints[k], course},
                             nullptr,
                             nullptr});
      if (pins) {
        transitions.back().pins =
            std::make_unique<PinnedTransition>(graph, *pins, k, from, to, joints[k],
                                               whole_turns(turns, extra.row(static_cast<Eigen::Index>(k))));
      }
      reports.push_back({transitions.back().edges.iterations(), transitions.back().edges.converged()});
    }
    if (options.smooth) join_transitions();
    for (std::size_t k = 0; k < anchors.size(); ++k) repair(k, progress_of(options, 0.5, k));
    if (!pins) return;
    const auto largest = std::max_element(
        keys.begin(), keys.end(), [](const Points& a, const Points& b) { return diameter(a) < diameter(b); });
    holders = std::make_unique<PerThread<PinHolder>>(
        team, [this, largest] { return std::make_unique<PinHolder>(*largest, pins->triangles); });
  }

  /// Of edges, with the extra whole turns of their parts.
  Eigen::VectorXd whole_turns(Eigen::VectorXd edge_turns, const Eigen::RowVectorXi& extra) const {
    for (Eigen::Index i = 0; i < edge_turns.size(); ++i) {
      const int v = graph.edges[static_cast<std::size_t>(i)][0];
      edge_turns[i] += 2.0 * std::numbers::pi * extra[graph.part[static_cast<std::size_t>(v)]];
    }
    return edge_turns;
  }

  /// Of the work on one transition, which is done in halves: first all are solved, then all are repaired.
  std::function<void(double)> progress_of(const InbetweenOptions& options, double begin,
                                          std::size_t k) const {
    const auto n_transitions = static_cast<double>(keys.size() - 1);
    const double start = begin + 0.5 * static_cast<double>(k) / n_transitions;
    return [&progress = options.progress, start, n_transitions](double done) {
      if (progress && !progress(start + 0.5 * done / n_transitions)) throw Cancelled();
    };
  }

  void join_transitions() {
    for (std::size_t k = 1; k < transitions.size(); ++k) {
      const auto key = static_cast<Eigen::Index>(k);
      const KeyGaps gaps = key_gaps(times[key - 1], times[key], times[key + 1]);
      MidpointTransition::join(transitions[k - 1].edges, transitions[k].edges, gaps);
      PartPlacer::join(transitions[k - 1].placer, transitions[k].placer, gaps);
      if (pins) PinnedTransition::join(*transitions[k - 1].pins, *transitions[k].pins, gaps);
    }
  }

  void repair(std::size_t k, const std::function<void(double)>& progress) {
    progress(0.0);
    const auto unrepaired = [&](const Eigen::VectorXd& u) {
      return frames(
          std::vector<Eigen::Index>(static_cast<std::size_t>(u.size()), static_cast<Eigen::Index>(k)), u,
          false);
    };
    auto repair = std::make_unique<FlipRepair>(graph, keys[k], keys[k + 1], transitions[k].edges.steps(),
                                               unrepaired, progress, team);
    reports[k].unrepaired = repair->hopeless_parts();
    reports[k].converged = reports[k].converged && repair->converged();
    if (repair->needed()) transitions[k].repair = std::move(repair);
  }

  /// Frames at shares u[i] of transitions k[i], a pass for FrameAssembler::lanes of them.
  std::vector<Points> frames(const std::vector<Eigen::Index>& k, const Eigen::VectorXd& u, bool repaired) {
    constexpr Eigen::Index lanes = FrameAssembler::lanes;
    std::vector<Points> result(k.size());
    const auto passes = static_cast<std::size_t>(FrameAssembler::padded(u.size()) / lanes);
    team.run(passes, [&](std::size_t pass, std::size_t thread) {
      ComplexRows edges = ComplexRows::Zero(static_cast<Eigen::Index>(graph.edges.size()), lanes);
      ComplexRows points(graph.n_vertices, lanes);
      const Eigen::Index first = static_cast<Eigen::Index>(pass) * lanes;
      const Eigen::Index count = std::min(lanes, u.size() - first);
      const auto transition = [&](Eigen::Index i) -> const Transition& {
        return transitions[static_cast<std::size_t>(k[static_cast<std::size_t>(first + i)])];
      };
      for (Eigen::Index i = 0; i < count; ++i) transition(i).edges.sample(u[first + i], edges, i);
      assembler.assemble(edges, 0, points);
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto row = static_cast<std::size_t>(first + i);
        const PartPlacer& placer = transition(i).placer;
        result[row] = placer.place(points, i, u[first + i]);
        const FlipRepair* repair = transition(i).repair.get();
        if (!repaired || !repair || u[first + i] < 0.0 || u[first + i] > 1.0) continue;
        Points upright = repair->repaired(result[row], u[first + i], thread);
        placer.hold_anchors(result[row], upright);
        result[row] = std::move(upright);
      }
    });
    return result;
  }

  /// Holds the pins of a frame at u of transition k, on a path (k×2, or none) where that is a number.
  void hold_pins(Points& frame, Eigen::Index k, double u, const Points* path, std::size_t thread) {
    const PinnedTransition& transition = *transitions[static_cast<std::size_t>(k)].pins;
    Points places = transition.places(u);
    for (Eigen::Index row = 0; path && row < places.rows(); ++row) {
      if (!path->row(row).hasNaN()) places.row(row) = path->row(row);
    }
    frame = transition.held(frame, places, holders->of(thread));
  }

  void require_paths(const std::vector<Points>& paths, Eigen::Index n_times) const {
    if (paths.empty()) return;
    if (!pins) throw std::invalid_argument("pin_paths: there are no pins");
    require_rows("pin_paths", static_cast<Eigen::Index>(paths.size()), n_times, "time");
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const std::string name = "pin_paths[" + std::to_string(i) + "]";
      require_rows(name.c_str(), paths[i].rows(), pins->handles.size(), "handle of pins");
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
    std::vector<Points> result(static_cast<std::size_t>(wanted.size()));
    std::vector<std::size_t> rows;  // those that are not keys
    std::vector<Eigen::Index> k;
    std::vector<double> u;
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
      k.push_back(transition);
      u.push_back(share);
    }
    // Pins take most of the time.
    const std::size_t at_a_time =
        pins ? std::max<std::size_t>(FrameAssembler::lanes, static_cast<std::size_t>(team.size()))
             : frames_at_a_time;
    for (std::size_t first = 0; first < rows.size(); first += at_a_time) {
      const std::size_t end = std::min(first + at_a_time, rows.size());
      if (progress && !progress(static_cast<double>(first) / static_cast<double>(rows.size()))) {
        throw Cancelled();
      }
      const auto count = static_cast<Eigen::Index>(end - first);
      std::vector<Points> solved = frames(
          {k.begin() + static_cast<std::ptrdiff_t>(first), k.begin() + static_cast<std::ptrdiff_t>(end)},
          Eigen::Map<const Eigen::VectorXd>(u.data() + first, count), true);
      if (pins) {
        team.run(solved.size(), [&](std::size_t i, std::size_t thread) {
          const std::size_t row = first + i;
          hold_pins(solved[i], k[row], u[row], paths.empty() ? nullptr : &paths[rows[row]], thread);
        });
      }
      for (std::size_t i = first; i < end; ++i) result[rows[i]] = std::move(solved[i - first]);
    }
    return result;
  }

  std::vector<Points> keys;
  Eigen::VectorXd times;
  EdgeGraph graph;
  FrameAssembler assembler;
  ThreadTeam team;
  std::unique_ptr<FramePins> pins;  ///< none if there are no pins
  std::vector<Transition> transitions;
  std::vector<TransitionReport> reports;
  std::unique_ptr<PerThread<PinHolder>> holders;  ///< where there are pins
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
