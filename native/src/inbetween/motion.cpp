// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/motion.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "inbetween/edge_turns.h"
#include "inbetween/inbetween_input.h"

namespace planar {

Motion::Motion(const std::vector<Points>& shapes, EdgeGraph edge_graph, const InbetweenOptions& options,
               const std::vector<Ties>& ties)
    : keys_(shapes),
      times_(key_times_of(keys_, options)),
      graph_(std::move(edge_graph)),
      assembler_(graph_),
      team_(options.threads) {
  const Eigen::MatrixXi extra = turns_of(graph_, keys_, options);
  const std::vector<Points> references = references_of(keys_, options);
  const double limit = options.tolerance * size_of(references);
  assembler_.factorize(frozen_weights(graph_, references));
  const EdgeTurns unwrapped(graph_);
  transitions_.reserve(ties.size());
  for (std::size_t k = 0; k < ties.size(); ++k) {
    const Points &from = keys_[k], &to = keys_[k + 1];
    const Eigen::VectorXd turns = unwrapped.between(from, to);
    const Eigen::VectorXd part_turns = mean_turns(graph_, turns, from, to);
    PartPlacer::Course course{part_turns, Eigen::VectorXd::Zero(graph_.n_parts)};
    // Extra turns are about the anchor; on its arc they would be orbits.
    if (options.anchor_path == AnchorPath::arc) course.arc_turns = PartPlacer::arcs(part_turns);
    course.turns +=
        2.0 * std::numbers::pi * extra.row(static_cast<Eigen::Index>(k)).transpose().cast<double>();
    const MidpointTransition::Settings settings{limit, options.max_iterations, progress_of(options, 0.0, k)};
    settings.progress(0.0);
    transitions_.push_back({{graph_, assembler_, from, to, turns, part_turns, settings, team_},
                            {graph_, from, to, ties[k], course},
                            nullptr});
    reports_.push_back({transitions_.back().edges.iterations(), transitions_.back().edges.converged()});
  }
  if (options.smooth) join_transitions();
  for (std::size_t k = 0; k < ties.size(); ++k) repair(k, progress_of(options, 0.5, k));
}

std::function<void(double)> Motion::progress_of(const InbetweenOptions& options, double begin,
                                                std::size_t k) const {
  const auto n_transitions = static_cast<double>(keys_.size() - 1);
  const double start = begin + 0.5 * static_cast<double>(k) / n_transitions;
  return [&progress = options.progress, start, n_transitions](double done) {
    if (progress && !progress(start + 0.5 * done / n_transitions)) throw Cancelled();
  };
}

void Motion::join_transitions() {
  for (std::size_t k = 1; k < transitions_.size(); ++k) {
    const auto key = static_cast<Eigen::Index>(k);
    const KeyGaps gaps = key_gaps(times_[key - 1], times_[key], times_[key + 1]);
    MidpointTransition::join(transitions_[k - 1].edges, transitions_[k].edges, gaps);
    PartPlacer::join(transitions_[k - 1].placer, transitions_[k].placer, gaps);
  }
}

void Motion::repair(std::size_t k, const std::function<void(double)>& progress) {
  progress(0.0);
  const auto unrepaired = [&](const Eigen::VectorXd& u) {
    return frames(std::vector<Eigen::Index>(static_cast<std::size_t>(u.size()), static_cast<Eigen::Index>(k)),
                  u, false);
  };
  auto repair = std::make_unique<FlipRepair>(graph_, keys_[k], keys_[k + 1], transitions_[k].edges.steps(),
                                             unrepaired, progress, team_);
  reports_[k].unrepaired = repair->hopeless_parts();
  reports_[k].converged = reports_[k].converged && repair->converged();
  if (repair->needed()) transitions_[k].repair = std::move(repair);
}

std::vector<Points> Motion::frames(const std::vector<Eigen::Index>& k, const Eigen::VectorXd& u,
                                   bool repaired) {
  constexpr Eigen::Index lanes = FrameAssembler::lanes;
  std::vector<Points> result(k.size());
  const auto passes = static_cast<std::size_t>(FrameAssembler::padded(u.size()) / lanes);
  team_.run(passes, [&](std::size_t pass, std::size_t thread) {
    ComplexRows edges = ComplexRows::Zero(static_cast<Eigen::Index>(graph_.edges.size()), lanes);
    ComplexRows points(graph_.n_vertices, lanes);
    const Eigen::Index first = static_cast<Eigen::Index>(pass) * lanes;
    const Eigen::Index count = std::min(lanes, u.size() - first);
    const auto transition = [&](Eigen::Index i) -> const Transition& {
      return transitions_[static_cast<std::size_t>(k[static_cast<std::size_t>(first + i)])];
    };
    for (Eigen::Index i = 0; i < count; ++i) transition(i).edges.sample(u[first + i], edges, i);
    assembler_.assemble(edges, 0, points);
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

std::vector<Points> Motion::sample(const std::vector<Moment>& moments) {
  std::vector<Eigen::Index> k;
  Eigen::VectorXd u(static_cast<Eigen::Index>(moments.size()));
  for (std::size_t i = 0; i < moments.size(); ++i) {
    k.push_back(static_cast<Eigen::Index>(moments[i].k));
    u[static_cast<Eigen::Index>(i)] = moments[i].u;
  }
  return frames(k, u, true);
}

}  // namespace planar
