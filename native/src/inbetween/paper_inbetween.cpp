// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/paper_inbetween.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "base/checks.h"
#include "base/complex_product.h"
#include "inbetween/edge_equations.h"
#include "inbetween/edge_turns.h"
#include "inbetween/frame_assembler.h"
#include "inbetween/global_step.h"
#include "inbetween/inbetween_input.h"
#include "inbetween/part_placer.h"
#include "parallel/per_thread.h"
#include "parallel/thread_team.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index edges_per_task = 64;
constexpr Eigen::Index frames_at_a_time = 16;  // between two calls of progress

using Progress = std::function<void(double)>;

void require_uniform(const Eigen::VectorXd& times, const Eigen::VectorXd& key_times) {
  if (key_times.size() != 2) {
    throw std::invalid_argument("keys: the paper's methods take two; use midpoint for more");
  }
  if (times.size() < 2) {
    throw std::invalid_argument("times: the paper's methods need at least the two times of the keys");
  }
  const Eigen::VectorXd uniform = Eigen::VectorXd::LinSpaced(times.size(), key_times[0], key_times[1]);
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    if (!(std::abs(times[i] - uniform[i]) <= 1e-6 * (uniform[1] - uniform[0]))) {
      throw std::invalid_argument(
          row_of("times", i) +
          "the paper's methods sample uniformly from the first key to the second; use "
          "midpoint for other times");
    }
  }
}

/// [AIAP 13], written so that an edge without length at one end is no special case.
ComplexRows first_edges(const EdgeGraph& graph, const Points& from, const Points& to,
                        const Eigen::VectorXd& turns, Eigen::Index last) {
  ComplexRows edges(turns.size(), last + 1);
  for (Eigen::Index i = 0; i < turns.size(); ++i) {
    const Complex first = graph.vector(static_cast<std::size_t>(i), from);
    const Complex end = graph.vector(static_cast<std::size_t>(i), to);
    const Complex change = product(end, std::polar(1.0, -turns[i])) - first;
    for (Eigen::Index k = 0; k < last; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(last);
      edges(i, k) = product(std::polar(1.0, t * turns[i]), first + t * change);
    }
    edges(i, last) = end;
  }
  return edges;
}

/// [AIAP 10] for each inner frame, with its own weights. Columns of `points` are frames.
class LocalStep {
 public:
  LocalStep(const EdgeGraph& graph, ThreadTeam& team)
      : graph_(graph),
        team_(team),
        assemblers_(team, [&graph] { return std::make_unique<FrameAssembler>(graph); }) {}

  void assemble(const ComplexRows& edges, ComplexRows& points, const Progress& progress) {
    const Eigen::Index end = edges.cols() - 1;
    for (Eigen::Index first = 1; first < end; first += frames_at_a_time) {
      progress(static_cast<double>(first) / static_cast<double>(end));
      const Eigen::Index count = std::min(frames_at_a_time, end - first);
      team_.run(static_cast<std::size_t>(count), [&](std::size_t frame, std::size_t thread) {
        const Eigen::Index column = first + static_cast<Eigen::Index>(frame);
        const ComplexRows e = edges.col(column);
        const Eigen::VectorXd length = e.abs2().sqrt().matrix();  // without the cost of hypot
        const double mean = length.mean();
        ComplexRows p(graph_.n_vertices, 1);
        FrameAssembler& assembler = assemblers_.of(thread);
        assembler.factorize(mean * length.cwiseMax(1e-4 * mean).cwiseInverse());
        assembler.assemble_one(e, p);
        points.col(column) = p;
      });
    }
  }

  /// [AIAP 8] and [AIAP 9], from the edges of the assembled frames.
  void relax(ComplexRows& edges) {
    team_.run_blocks(edges.rows(), edges_per_task,
                     [&](Eigen::Index i) { minimise_edge_energy(edges.row(i)); });
  }

 private:
  const EdgeGraph& graph_;
  ThreadTeam& team_;
  PerThread<FrameAssembler> assemblers_;
};

}  // namespace

Eigen::VectorXd breadth_first_turns(const EdgeGraph& graph, const Points& from, const Points& to) {
  Eigen::VectorXd turns(static_cast<Eigen::Index>(graph.edges.size()));
  std::vector<std::vector<std::size_t>> edges_at(graph.vertex_count());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    turns[static_cast<Eigen::Index>(i)] =
        std::arg(product(graph.vector(i, to), std::conj(graph.vector(i, from))));
    for (const int v : graph.edges[i]) edges_at[static_cast<std::size_t>(v)].push_back(i);
  }
  std::vector<char> visited(graph.edges.size());
  std::vector<std::size_t> queue;
  for (std::size_t start = 0; start < graph.edges.size(); ++start) {
    if (visited[start]) continue;
    visited[start] = 1;
    queue.assign(1, start);
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const double parent = turns[static_cast<Eigen::Index>(queue[next])];
      for (const int v : graph.edges[queue[next]]) {
        for (const std::size_t i : edges_at[static_cast<std::size_t>(v)]) {
          if (visited[i]) continue;
          visited[i] = 1;
          double& child = turns[static_cast<Eigen::Index>(i)];
          child = parent + wrapped(child - parent);
          queue.push_back(i);
        }
      }
    }
  }
  return turns;
}

std::vector<Points> paper_inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                                    const EdgeGraph& graph, const InbetweenOptions& options) {
  require_iteration(options);
  if (options.smooth) throw std::invalid_argument("smooth: the paper's methods are not; use midpoint");
  if (options.cage) throw std::invalid_argument("cage: the paper's methods have none; use midpoint");
  require_uniform(times, key_times_of(keys, options));
  const Eigen::VectorXi anchor = anchors_of(graph, keys, options)[0];
  const Edges joints = joints_of(graph, keys, options)[0];
  Eigen::VectorXd turns = breadth_first_turns(graph, keys[0], keys[1]);
  PartPlacer::Course course{Eigen::VectorXd::Zero(graph.n_parts), Eigen::VectorXd::Zero(graph.n_parts)};
  if (options.anchor_path == AnchorPath::arc) {
    course.arc_turns = PartPlacer::arcs(mean_turns(graph, turns, keys[0], keys[1]));
  }
  const Eigen::MatrixXi extra = turns_of(graph, keys, options);
  for (Eigen::Index i = 0; i < turns.size(); ++i) {
    const int part = graph.part[static_cast<std::size_t>(graph.edges[static_cast<std::size_t>(i)][0])];
    turns[i] += 2.0 * std::numbers::pi * extra(0, part);
  }

  const Eigen::Index last = times.size() - 1;
  ComplexRows edges = first_edges(graph, keys[0], keys[1], turns, last);
  ComplexRows points = ComplexRows::Zero(graph.n_vertices, last + 1), before;
  const double size = size_of(references_of(keys, options));
  const double tolerance = options.tolerance * size;
  if (options.progress && !options.progress(0.0)) throw Cancelled();  // the factor is next
  ThreadTeam team(options.threads);
  std::optional<LocalStep> local;
  std::optional<GlobalStep> global;
  if (options.method == InbetweenMethod::paper) {
    local.emplace(graph, team);
  } else {
    global.emplace(graph, team);
  }
  for (int iteration = 0; last > 1; ++iteration) {
    const Progress progress = [&options, done = iteration](double share) {
      // Nobody knows how many there will be.
      const double begin = done / (done + 4.0), end = (done + 1.0) / (done + 5.0);
      if (options.progress && !options.progress(begin + share * (end - begin))) throw Cancelled();
    };
    progress(0.0);
    before = points;
    if (local) {
      if (iteration > 0) local->relax(edges);
      local->assemble(edges, points, progress);
    } else {
      global->assemble(edges, points, progress);
    }
    const double furthest = std::sqrt((points - before).abs2().maxCoeff<Eigen::PropagateNaN>());
    if (!std::isfinite(furthest) || furthest > 1e6 * size) {
      throw SolveError(
          "the paper's iteration diverges: its steps turn edges too far; take more frames or midpoint");
    }
    for (Eigen::Index i = 0; i < edges.rows(); ++i) {
      const auto [a, b] = graph.edges[static_cast<std::size_t>(i)];
      edges.row(i).segment(1, last - 1) = (points.row(b) - points.row(a)).segment(1, last - 1);
    }
    if (iteration > 0 && furthest < tolerance) break;
    if (iteration == options.max_iterations) break;
  }

  const PartPlacer placer(graph, keys[0], keys[1], {anchor, joints}, course);
  std::vector<Points> frames{keys[0]};
  for (Eigen::Index k = 1; k < last; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(last);
    frames.push_back(placer.place(points, k, u));
  }
  frames.push_back(keys[1]);
  return frames;
}

}  // namespace planar
