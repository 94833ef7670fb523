// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/inbetween.h"

#include <algorithm>
#include <numbers>
#include <string>

#include "checks.h"
#include "edge_turns.h"
#include "flip_repair.h"
#include "inbetween_input.h"
#include "midpoint_transition.h"
#include "paper_inbetween.h"
#include "part_placer.h"
#include "thread_team.h"

namespace planar {

struct Inbetweens::State {
  /// What moves from keys[k] to keys[k+1].
  struct Transition {
    MidpointTransition edges;
    PartPlacer::Course course;
    std::unique_ptr<FlipRepair> repair;  ///< none if there is nothing to repair
  };

  State(const std::vector<Points>& shapes, EdgeGraph edge_graph, const InbetweenOptions& options)
      : keys(shapes),
        times(key_times_of(keys, options)),
        graph(std::move(edge_graph)),
        placer(graph, options.anchor),
        assembler(graph),
        team(options.threads) {
    require_iteration(options);
    if (options.method != InbetweenMethod::midpoint) {
      throw std::invalid_argument("method: only midpoint can be sampled at any time");
    }
    const auto n_transitions = static_cast<Eigen::Index>(keys.size()) - 1;
    const Eigen::MatrixXi extra = turns_of(graph, keys, options);
    const std::vector<Points> references = references_of(keys, options);
    const double tolerance = options.tolerance * diagonal_of(references);
    assembler.factorize(frozen_weights(graph, references));
    const EdgeTurns unwrapped(graph);
    for (Eigen::Index k = 0; k < n_transitions; ++k) {
      const Points &from = keys[static_cast<std::size_t>(k)], &to = keys[static_cast<std::size_t>(k) + 1];
      const Eigen::VectorXd turns = unwrapped.between(from, to);
      const Eigen::VectorXd part_turns = mean_turns(graph, turns, from, to);
      PartPlacer::Course course{part_turns, Eigen::VectorXd::Zero(graph.n_parts)};
      // Extra turns are about the anchor; on its arc they would be orbits.
      if (options.anchor_path == AnchorPath::arc) course.arc_turns = PartPlacer::arcs(part_turns);
      course.turns += 2.0 * std::numbers::pi * extra.row(k).transpose().cast<double>();
      const MidpointTransition::Settings settings{tolerance, options.max_iterations, [&](double done) {
                                                    const double share = (static_cast<double>(k) + done) /
                                                                         static_cast<double>(n_transitions);
                                                    if (options.progress && !options.progress(share))
                                                      throw Cancelled();
                                                  }};
      settings.progress(0.0);
      MidpointTransition edges(graph, assembler, from, to, turns, part_turns, settings, team);
      const Eigen::Index steps = edges.steps();
      transitions.push_back({std::move(edges), std::move(course), nullptr});
      const auto unrepaired = [&](const Eigen::VectorXd& u) {
        return frames(std::vector<Eigen::Index>(static_cast<std::size_t>(u.size()), k), u, false);
      };
      auto repair = std::make_unique<FlipRepair>(graph, from, to, steps, unrepaired, settings.progress, team);
      if (repair->needed()) transitions.back().repair = std::move(repair);
    }
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
        const auto key = static_cast<std::size_t>(k[row]);
        result[row] = placer.place(points, i, keys[key], keys[key + 1], u[first + i], transition(i).course);
        const FlipRepair* repair = transition(i).repair.get();
        if (!repaired || !repair) continue;
        Points upright = repair->repaired(result[row], u[first + i], thread);
        placer.hold_anchors(result[row], upright);
        result[row] = std::move(upright);
      }
    });
    return result;
  }

  std::vector<Points> sample(const Eigen::VectorXd& wanted) {
    std::vector<Points> result(static_cast<std::size_t>(wanted.size()));
    std::vector<std::size_t> rows;  // those that are not keys
    std::vector<Eigen::Index> k;
    std::vector<double> u;
    for (Eigen::Index i = 0; i < wanted.size(); ++i) {
      const double time = wanted[i];
      if (!(time >= times[0] && time <= times[times.size() - 1])) {
        throw std::invalid_argument(row_of("times", i) + "outside of the keys' times");
      }
      const auto row = static_cast<std::size_t>(i);
      const auto* after = std::upper_bound(times.data(), times.data() + times.size(), time);
      const Eigen::Index before = after - times.data() - 1;
      if (time == times[before]) {
        result[row] = keys[static_cast<std::size_t>(before)];
      } else {
        rows.push_back(row);
        k.push_back(before);
        u.push_back((time - times[before]) / (times[before + 1] - times[before]));
      }
    }
    std::vector<Points> solved =
        frames(k, Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size())), true);
    for (std::size_t i = 0; i < rows.size(); ++i) result[rows[i]] = std::move(solved[i]);
    return result;
  }

  std::vector<Points> keys;
  Eigen::VectorXd times;
  EdgeGraph graph;
  PartPlacer placer;
  FrameAssembler assembler;
  ThreadTeam team;
  std::vector<Transition> transitions;
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
  if (options.method == InbetweenMethod::midpoint) return Inbetweens(keys, elements, options).at(times);
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

Points Inbetweens::at(double time) const {
  return state_->sample(Eigen::VectorXd::Constant(1, time)).front();
}

std::vector<Points> Inbetweens::at(const Eigen::VectorXd& times) const { return state_->sample(times); }

std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Triangles& triangles, const InbetweenOptions& options) {
  return frames(keys, times, triangles, options);
}

std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Edges& edges, const InbetweenOptions& options) {
  return frames(keys, times, edges, options);
}

}  // namespace planar
