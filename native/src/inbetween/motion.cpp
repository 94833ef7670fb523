// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/motion.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "base/diameter.h"
#include "base/index.h"
#include "inbetween/edge_turns.h"
#include "inbetween/inbetween_input.h"

namespace planar {

namespace {

/// Of edges, with the extra whole turns of their parts.
Eigen::VectorXd whole_turns(const EdgeGraph& graph, Eigen::VectorXd edge_turns,
                            const Eigen::RowVectorXi& extra) {
  for (Eigen::Index i = 0; i < edge_turns.size(); ++i) {
    const int v = graph.edges[static_cast<std::size_t>(i)][0];
    edge_turns[i] += 2.0 * std::numbers::pi * extra[graph.part[at(v)]];
  }
  return edge_turns;
}

}  // namespace

Motion::Motion(const std::vector<Points>& shapes, EdgeGraph edge_graph, const InbetweenOptions& options,
               const std::vector<Ties>& ties, std::unique_ptr<FramePins> pins)
    : keys_(shapes),
      times_(key_times_of(keys_, options)),
      graph_(std::move(edge_graph)),
      assembler_(graph_),
      team_(options.threads),
      pins_(std::move(pins)) {
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
                            nullptr,
                            nullptr});
    if (pins_) {
      transitions_.back().pins = std::make_unique<PinnedTransition>(
          graph_, *pins_, k, whole_turns(graph_, turns, extra.row(static_cast<Eigen::Index>(k))));
    }
    reports_.push_back({transitions_.back().edges.iterations(), transitions_.back().edges.converged()});
  }
  if (options.smooth) join_transitions();
  for (std::size_t k = 0; k < ties.size(); ++k) repair(k, progress_of(options, 0.5, k));
  if (!pins_) return;
  const auto largest = std::max_element(
      keys_.begin(), keys_.end(), [](const Points& a, const Points& b) { return diameter(a) < diameter(b); });
  holders_ = std::make_unique<PerThread<PinHolder>>(
      team_, [this, largest] { return std::make_unique<PinHolder>(*largest, pins_->triangles); });
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
    if (pins_) PinnedTransition::join(*transitions_[k - 1].pins, *transitions_[k].pins, gaps);
  }
}

void Motion::repair(std::size_t k, const std::function<void(double)>& progress) {
  progress(0.0);
  const auto unrepaired = [&](const Eigen::VectorXd& u) {
    std::vector<Moment> moments;
    moments.reserve(at(u.size()));
    for (const double share : u) moments.push_back({k, share});
    return frames(moments, false);
  };
  auto repair = std::make_unique<FlipRepair>(graph_, keys_[k], keys_[k + 1], transitions_[k].edges.steps(),
                                             unrepaired, progress, team_);
  reports_[k].unrepaired = repair->hopeless_parts();
  reports_[k].converged = reports_[k].converged && repair->converged();
  if (repair->needed()) transitions_[k].repair = std::move(repair);
}

std::vector<Points> Motion::frames(const std::vector<Moment>& moments, bool repaired) {
  constexpr Eigen::Index lanes = FrameAssembler::lanes;
  const auto n_moments = static_cast<Eigen::Index>(moments.size());
  std::vector<Points> result(moments.size());
  const auto passes = static_cast<std::size_t>(FrameAssembler::padded(n_moments) / lanes);
  team_.run(passes, [&](std::size_t pass, std::size_t thread) {
    ComplexRows edges = ComplexRows::Zero(static_cast<Eigen::Index>(graph_.edges.size()), lanes);
    ComplexRows points(graph_.n_vertices, lanes);
    const Eigen::Index first = static_cast<Eigen::Index>(pass) * lanes;
    const Eigen::Index count = std::min(lanes, n_moments - first);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto [k, u] = moments[at(first + i)];
      transitions_[k].edges.sample(u, edges, i);
    }
    assembler_.assemble(edges, 0, points);
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::size_t row = at(first + i);
      const auto [k, u] = moments[row];
      const PartPlacer& placer = transitions_[k].placer;
      result[row] = placer.place(points, i, u);
      const FlipRepair* repair = transitions_[k].repair.get();
      if (!repaired || !repair || u < 0.0 || u > 1.0) continue;
      Points upright = repair->repaired(result[row], u, thread);
      placer.hold_anchors(result[row], upright);
      result[row] = std::move(upright);
    }
  });
  return result;
}

std::size_t Motion::frames_at_a_time() const {
  constexpr std::size_t several = 16;
  // Pins take most of the time.
  const auto few = static_cast<std::size_t>(std::max<Eigen::Index>(FrameAssembler::lanes, team_.size()));
  return pins_ ? few : several;
}

void Motion::hold_pins(Points& frame, const Moment& moment, const Points* path, std::size_t thread) {
  const PinnedTransition& transition = *transitions_[moment.k].pins;
  Points places = transition.places(moment.u);
  for (Eigen::Index row = 0; path && row < places.rows(); ++row) {
    if (!path->row(row).hasNaN()) places.row(row) = path->row(row);
  }
  frame = transition.held(frame, moment.u, places, holders_->of(thread));
}

std::vector<Points> Motion::sample(const std::vector<Moment>& moments,
                                   const std::function<const Points*(std::size_t i)>& path) {
  std::vector<Points> result = frames(moments, true);
  if (pins_) {
    team_.run(result.size(),
              [&](std::size_t i, std::size_t thread) { hold_pins(result[i], moments[i], path(i), thread); });
  }
  return result;
}

}  // namespace planar
