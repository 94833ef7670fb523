// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/paper_inbetween.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "base/checks.h"
#include "base/complex_product.h"
#include "inbetween/edge_turns.h"
#include "inbetween/frame_assembler.h"
#include "inbetween/inbetween_input.h"
#include "inbetween/part_placer.h"
#include "linear/tridiagonal.h"
#include "parallel/thread_team.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr std::size_t edges_per_task = 64;

/// Δt c of (8) at the first and at the second frame of a pair: by the forward and by the backward difference.
struct Rates {
  Rates(Complex first, Complex second) {
    const double area = product(std::conj(first), second).imag();
    if (std::norm(first) > 0.0) forward = area / std::norm(first);
    if (std::norm(second) > 0.0) reverse = area / std::norm(second);
  }
  double forward = 0.0, reverse = 0.0;
};

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

/// (13), written so that an edge without length at one end is no special case.
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

/// (10) for each inner frame, with its own weights. Columns of `points` are frames.
class LocalStep {
 public:
  LocalStep(const EdgeGraph& graph, ThreadTeam& team) : graph_(graph), team_(team) {
    for (int i = 0; i < team.size(); ++i) assemblers_.push_back(std::make_unique<FrameAssembler>(graph));
  }

  void assemble(const ComplexRows& edges, ComplexRows& points) {
    team_.run(static_cast<std::size_t>(edges.cols()) - 2, [&](std::size_t frame, std::size_t thread) {
      const auto column = static_cast<Eigen::Index>(frame) + 1;
      const ComplexRows e = edges.col(column);
      const Eigen::VectorXd length = e.abs2().sqrt().matrix();  // without the cost of hypot
      const double mean = length.mean();
      ComplexRows p(graph_.n_vertices, 1);
      FrameAssembler& assembler = *assemblers_[thread];
      assembler.factorize(mean * length.cwiseMax(1e-4 * mean).cwiseInverse());
      assembler.assemble_one(e, p);
      points.col(column) = p;
    });
  }

  /// (8) and (9), from the edges of the assembled frames.
  void relax(ComplexRows& edges) {
    const auto n_edges = static_cast<std::size_t>(edges.rows());
    team_.run((n_edges + edges_per_task - 1) / edges_per_task, [&](std::size_t block, std::size_t) {
      const std::size_t end = std::min((block + 1) * edges_per_task, n_edges);
      for (std::size_t i = block * edges_per_task; i < end; ++i) {
        minimise_edge_energy(edges.row(static_cast<Eigen::Index>(i)));
      }
    });
  }

 private:
  const EdgeGraph& graph_;
  ThreadTeam& team_;
  std::vector<std::unique_ptr<FrameAssembler>> assemblers_;
};

/// (6) for all inner frames at once, with c by (8) of the edges as they are. Unknown v + n (k-1) is vertex v
/// of frame k.
class GlobalStep {
 public:
  explicit GlobalStep(const EdgeGraph& graph) : graph_(graph) {}

  void assemble(const ComplexRows& edges, ComplexRows& points) {
    const Eigen::Index last = edges.cols() - 1, size = graph_.n_vertices * (last - 1);
    std::vector<Eigen::Triplet<Complex>> entries;
    Eigen::VectorXcd right = Eigen::VectorXcd::Zero(size);
    // Adds |x_second·e[k+1] + x_first·e[k]|² of an edge from a to b.
    const auto add = [&](Eigen::Index i, Eigen::Index k, Complex x_first, Complex x_second) {
      const auto [a, b] = graph_.edges[static_cast<std::size_t>(i)];
      struct Term {
        Eigen::Index frame;
        int vertex;
        Complex factor;
      };
      const std::array<Term, 4> terms{
          {{k, a, -x_first}, {k, b, x_first}, {k + 1, a, -x_second}, {k + 1, b, x_second}}};
      const auto inner = [last](Eigen::Index frame) { return frame > 0 && frame < last; };
      const auto unknown = [this](const Term& term) {
        return term.vertex + graph_.n_vertices * (term.frame - 1);
      };
      Complex known = 0.0;
      if (!inner(k)) known += x_first * edges(i, k);
      if (!inner(k + 1)) known += x_second * edges(i, k + 1);
      for (const Term& row : terms) {
        if (!inner(row.frame)) continue;
        right[unknown(row)] -= std::conj(row.factor) * known;
        for (const Term& column : terms) {
          if (inner(column.frame) && unknown(column) <= unknown(row)) {
            entries.emplace_back(unknown(row), unknown(column), std::conj(row.factor) * column.factor);
          }
        }
      }
    };
    for (Eigen::Index i = 0; i < edges.rows(); ++i) {
      for (Eigen::Index k = 0; k < last; ++k) {
        const Rates rates(edges(i, k), edges(i, k + 1));
        add(i, k, -Complex(1.0, rates.forward), 1.0);
        add(i, k, -1.0, Complex(1.0, -rates.reverse));
      }
    }
    // Frames may be translated freely, and the right side knows it: holding a vertex of each part holds it at
    // 0.
    int parts_seen = 0;
    for (int v = 0; v < graph_.n_vertices; ++v) {
      const int part = graph_.part[static_cast<std::size_t>(v)];
      if (part != -1 && part != parts_seen) continue;
      if (part != -1) ++parts_seen;
      for (Eigen::Index k = 0; k + 1 < last; ++k) {
        entries.emplace_back(v + graph_.n_vertices * k, v + graph_.n_vertices * k, 1.0);
      }
    }
    Eigen::SparseMatrix<Complex> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (!analyzed_) factor_.analyzePattern(matrix);
    analyzed_ = true;
    factor_.factorize(matrix);
    if (factor_.info() != Eigen::Success) throw SolveError("the frames of (6) cannot be solved");
    const Eigen::VectorXcd x = factor_.solve(right);
    points.middleCols(1, last - 1) =
        Eigen::Map<const Eigen::ArrayXXcd>(x.data(), graph_.n_vertices, last - 1);
  }

 private:
  const EdgeGraph& graph_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> factor_;
  bool analyzed_ = false;
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

void minimise_edge_energy(Eigen::Ref<Eigen::Array<Complex, 1, Eigen::Dynamic, Eigen::RowMajor>> e) {
  const Eigen::Index last = e.size() - 1;
  if (last < 2) return;
  const auto n = static_cast<std::size_t>(last - 1);
  // |e[k+1] - (1 + iα_k) e[k]|² + |(1 - iβ_k) e[k+1] - e[k]|², summed.
  std::vector<double> diagonal(n, 2.0);
  std::vector<Complex> below(n), x(n);
  for (Eigen::Index k = 0; k < last; ++k) {
    const Rates rates(e[k], e[k + 1]);
    const auto i = static_cast<std::size_t>(k);
    const Complex coupling(-2.0, -rates.forward - rates.reverse);
    if (k > 0) diagonal[i - 1] += 1.0 + rates.forward * rates.forward;
    if (k + 1 < last) diagonal[i] += 1.0 + rates.reverse * rates.reverse;
    if (k == 0) x[0] -= product(coupling, e[0]);
    if (k + 1 == last) x[n - 1] -= product(std::conj(coupling), e[last]);
    if (k > 0 && k + 1 < last) below[i - 1] = coupling;
  }
  solve_tridiagonal(diagonal, below, x);
  for (std::size_t i = 0; i < n; ++i) e[static_cast<Eigen::Index>(i) + 1] = x[i];
}

std::vector<Points> paper_inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                                    const EdgeGraph& graph, const InbetweenOptions& options) {
  require_iteration(options);
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
  const double diagonal = diagonal_of(references_of(keys, options));
  const double tolerance = options.tolerance * diagonal;
  ThreadTeam team(options.threads);
  LocalStep local(graph, team);
  GlobalStep global(graph);
  for (int iteration = 0; last > 1; ++iteration) {
    before = points;
    if (options.method == InbetweenMethod::paper) {
      if (iteration > 0) local.relax(edges);
      local.assemble(edges, points);
    } else {
      global.assemble(edges, points);
    }
    const double furthest = std::sqrt((points - before).abs2().maxCoeff<Eigen::PropagateNaN>());
    if (!std::isfinite(furthest) || furthest > 1e6 * diagonal) {
      throw SolveError(
          "the paper's iteration diverges: its steps turn edges too far; take more frames or midpoint");
    }
    for (Eigen::Index i = 0; i < edges.rows(); ++i) {
      const auto [a, b] = graph.edges[static_cast<std::size_t>(i)];
      edges.row(i).segment(1, last - 1) = (points.row(b) - points.row(a)).segment(1, last - 1);
    }
    if (iteration > 0 && furthest < tolerance) break;
    if (iteration == options.max_iterations) break;
    if (options.progress && !options.progress(iteration / (iteration + 4.0))) throw Cancelled();
  }

  const PartPlacer placer(graph, keys[0], keys[1], anchor, joints, course);
  std::vector<Points> frames{keys[0]};
  for (Eigen::Index k = 1; k < last; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(last);
    frames.push_back(placer.place(points, k, u));
  }
  frames.push_back(keys[1]);
  return frames;
}

}  // namespace planar
