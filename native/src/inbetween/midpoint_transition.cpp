// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/midpoint_transition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/complex_product.h"
#include "inbetween/frame_relaxation.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double largest_turn = std::numbers::pi / 6.0;  // of an edge in one step of the grid
constexpr Eigen::Index fewest_steps = 8;
constexpr Eigen::Index most_steps = 64;
constexpr double largest_growth = 2.0;  // of a length outside of the keys, as a logarithm
constexpr Eigen::Index edges_per_task = 512;

Complex direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

void minimise_midpoint_energy(Eigen::Ref<Eigen::Array<Complex, 1, Eigen::Dynamic, Eigen::RowMajor>> e) {
  std::array<Complex, most_steps + 1> rotation;
  std::array<double, most_steps + 1> way;
  const Eigen::Index last = e.size() - 1;
  rotation[0] = 1.0;
  way[0] = 0.0;
  for (Eigen::Index k = 0; k < last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Complex sum = e[k] + e[k + 1], difference = e[k + 1] - e[k];
    // τ = sine / cosine; an edge that turns by half a turn in one step says nothing about how.
    const double cosine = std::norm(sum), sine = product(std::conj(sum), difference).imag();
    const double size = cosine * cosine + sine * sine;
    const bool plain = !(size > 0.0);
    const Complex half(cosine, sine);
    rotation[i + 1] = plain ? rotation[i] : product(rotation[i], product(half, half) / size);
    way[i + 1] = way[i] + (plain ? 1.0 : cosine * cosine / size);
  }
  const auto end = static_cast<std::size_t>(last);
  const Complex first = e[0], change = product(std::conj(rotation[end]), e[last]) - first;
  const double whole = way[end] > 0.0 ? way[end] : 1.0;
  for (std::size_t k = 1; k < end; ++k) {
    e[static_cast<Eigen::Index>(k)] = product(rotation[k], first + change * (way[k] / whole));
  }
}

MidpointTransition::MidpointTransition(const EdgeGraph& graph, const FrameAssembler& assembler,
                                       const Points& from, const Points& to,
                                       const Eigen::VectorXd& edge_turns, const Eigen::VectorXd& part_turns,
                                       const Settings& settings, ThreadTeam& team) {
  const Eigen::Index n_edges = edge_turns.size();
  Eigen::VectorXd turns(n_edges);  // relative to the part
  const auto part_turn = [&](Eigen::Index i) {
    return part_turns[graph.part[static_cast<std::size_t>(graph.edges[static_cast<std::size_t>(i)][0])]];
  };
  for (Eigen::Index i = 0; i < n_edges; ++i) turns[i] = edge_turns[i] - part_turn(i);
  const double most = turns.cwiseAbs().maxCoeff();
  // A little above an even number of steps would make a motion turned round take another one.
  const double wanted = std::ceil(most / largest_turn - 1e-6);
  steps_ = std::clamp(static_cast<Eigen::Index>(std::min(wanted, 1e3)), fewest_steps, most_steps);

  // [AIAP 13], written so that an edge without length at one end is no special case.
  edges_.resize(n_edges, steps_ + 1);
  team.run_blocks(n_edges, edges_per_task, [&](Eigen::Index i) {
    const Complex first = graph.vector(static_cast<std::size_t>(i), from);
    const Complex last = product(graph.vector(static_cast<std::size_t>(i), to), direction(-part_turn(i)));
    const Complex change = product(last, direction(-turns[i])) - first;
    for (Eigen::Index k = 0; k < steps_; ++k) {
      const double u = static_cast<double>(k) / static_cast<double>(steps_);
      edges_(i, k) = product(direction(u * turns[i]), first + u * change);
    }
    edges_(i, steps_) = last;
  });
  const ComplexRows points = iterate(graph, assembler, settings, team);
  if (graph.triangles.rows() > 0) relax(graph, from, to, points, settings, team);

  length_.resize(n_edges, steps_ + 1);
  angle_.resize(n_edges, steps_ + 1);
  team.run_blocks(n_edges, edges_per_task, [&](Eigen::Index i) {
    angle_(i, 0) = std::arg(edges_(i, 0));
    length_(i, 0) = std::abs(edges_(i, 0));
    for (Eigen::Index k = 1; k <= steps_; ++k) {
      angle_(i, k) = angle_(i, k - 1) + std::arg(product(edges_(i, k), std::conj(edges_(i, k - 1))));
      length_(i, k) = std::abs(edges_(i, k));
    }
  });
  edges_.resize(0, 0);
}

/// The points of the inner frames, columns 0..steps_-2.
ComplexRows MidpointTransition::iterate(const EdgeGraph& graph, const FrameAssembler& assembler,
                                        const Settings& settings, ThreadTeam& team) {
  // Columns 0 and steps_ are the keys; the unknown frames between them are columns of their own table.
  const Eigen::Index inner = steps_ - 1, padded = FrameAssembler::padded(inner);
  const auto passes = static_cast<std::size_t>(padded / FrameAssembler::lanes);
  ComplexRows wanted = ComplexRows::Zero(edges_.rows(), padded);
  ComplexRows points = ComplexRows::Zero(graph.n_vertices, padded), before;
  Eigen::VectorXd moved(static_cast<Eigen::Index>(passes));
  for (int iteration = 0;; ++iteration) {
    wanted.leftCols(inner) = edges_.middleCols(1, inner);
    std::swap(points, before);
    points.resize(graph.n_vertices, padded);
    team.run(passes, [&](std::size_t pass, std::size_t) {
      const Eigen::Index first = static_cast<Eigen::Index>(pass) * FrameAssembler::lanes;
      assembler.assemble(wanted, first, points);
      moved[static_cast<Eigen::Index>(pass)] =
          (points.middleCols(first, FrameAssembler::lanes) - before.middleCols(first, FrameAssembler::lanes))
              .abs2()
              .maxCoeff<Eigen::PropagateNaN>();
    });
    team.run_blocks(edges_.rows(), edges_per_task, [&](Eigen::Index i) {
      const auto [a, b] = graph.edges[static_cast<std::size_t>(i)];
      edges_.row(i).segment(1, inner) = points.row(b).head(inner) - points.row(a).head(inner);
    });
    const double furthest = std::sqrt(moved.maxCoeff<Eigen::PropagateNaN>());
    if (!std::isfinite(furthest))
      throw SolveError("the in-betweens overflow: are the keys' numbers sensible?");
    iterations_ = iteration;
    converged_ = iteration > 0 && furthest < settings.tolerance;
    if (converged_ || iteration == settings.max_iterations) return points;
    settings.progress(0.5 * iteration / (iteration + 4.0));  // most transitions take about four
    team.run_blocks(edges_.rows(), edges_per_task,
                    [&](Eigen::Index i) { minimise_midpoint_energy(edges_.row(i)); });
  }
}

void MidpointTransition::relax(const EdgeGraph& graph, const Points& from, const Points& to,
                               const ComplexRows& points, const Settings& settings, ThreadTeam& team) {
  const Eigen::Index inner = steps_ - 1;
  std::vector<Points> frames(static_cast<std::size_t>(inner));
  Eigen::VectorXd u(inner);
  for (Eigen::Index k = 0; k < inner; ++k) {
    u[k] = static_cast<double>(k + 1) / static_cast<double>(steps_);
    Points& frame = frames[static_cast<std::size_t>(k)];
    frame.resize(graph.n_vertices, 2);
    frame.col(0) = points.col(k).real();
    frame.col(1) = points.col(k).imag();
  }
  relax_frames(
      graph, from, to, u, frames, [&](double done) { settings.progress(0.5 + 0.5 * done); }, team);
  team.run_blocks(edges_.rows(), edges_per_task, [&](Eigen::Index i) {
    for (Eigen::Index k = 0; k < inner; ++k) {
      edges_(i, k + 1) = graph.vector(static_cast<std::size_t>(i), frames[static_cast<std::size_t>(k)]);
    }
  });
}

/// Per u, of the parabola through the outermost three frames.
double MidpointTransition::first_slope(const Table& of, Eigen::Index edge) const {
  return static_cast<double>(steps_) * (2.0 * of(edge, 1) - 1.5 * of(edge, 0) - 0.5 * of(edge, 2));
}

double MidpointTransition::last_slope(const Table& of, Eigen::Index edge) const {
  return static_cast<double>(steps_) *
         (1.5 * of(edge, steps_) - 2.0 * of(edge, steps_ - 1) + 0.5 * of(edge, steps_ - 2));
}

void MidpointTransition::join(MidpointTransition& before, MidpointTransition& after, KeyGaps gaps) {
  const auto n_edges = before.length_.rows();
  for (MidpointTransition* transition : {&before, &after}) {
    transition->length_change_.resize(static_cast<std::size_t>(n_edges));
    transition->angle_change_.resize(static_cast<std::size_t>(n_edges));
  }
  const auto meet = [&](Table MidpointTransition::*of,
                        std::vector<SlopeChange<double>> MidpointTransition::*change) {
    for (Eigen::Index i = 0; i < n_edges; ++i) {
      const auto edge = static_cast<std::size_t>(i);
      const double a = before.last_slope(before.*of, i), b = after.first_slope(after.*of, i);
      const double slope = slope_through_key(a / gaps.before, b / gaps.after, gaps);
      (before.*change)[edge].last = slope * gaps.before - a;
      (after.*change)[edge].first = slope * gaps.after - b;
    }
  };
  meet(&MidpointTransition::length_, &MidpointTransition::length_change_);
  meet(&MidpointTransition::angle_, &MidpointTransition::angle_change_);
}

void MidpointTransition::sample_outside(double u, ComplexRows& edges, Eigen::Index column) const {
  const bool first = u < 0.0;
  const Eigen::Index frame = first ? 0 : steps_;
  for (Eigen::Index i = 0; i < length_.rows(); ++i) {
    double stretch = first ? first_slope(length_, i) : last_slope(length_, i);
    double turn = first ? first_slope(angle_, i) : last_slope(angle_, i);
    if (!length_change_.empty()) {
      const auto edge = static_cast<std::size_t>(i);
      stretch += first ? length_change_[edge].first : length_change_[edge].last;
      turn += first ? angle_change_[edge].first : angle_change_[edge].last;
    }
    const double beyond = first ? u : u - 1.0, length = length_(i, frame);
    const double growth =
        length > 0.0 ? std::clamp(beyond * stretch / length, -largest_growth, largest_growth) : 0.0;
    edges(i, column) = length * std::exp(growth) * direction(angle_(i, frame) + beyond * turn);
  }
}

void MidpointTransition::sample(double u, ComplexRows& edges, Eigen::Index column) const {
  if (u < 0.0 || u > 1.0) {
    sample_outside(u, edges, column);
    return;
  }
  const double position = u * static_cast<double>(steps_);
  const Eigen::Index k =
      std::clamp(static_cast<Eigen::Index>(std::floor(position)), Eigen::Index{0}, steps_ - 1);
  const double t = position - static_cast<double>(k);
  // Cubic through the values at k and k+1 with the slopes of parabolas through three frames, so that the
  // motion has no kinks at the frames of the grid; as weights of the four values at k-1..k+2, or at the ends
  // of the outermost four.
  const Eigen::Index first = std::clamp(k - 1, Eigen::Index{0}, steps_ - 3);
  std::array<double, 4> weight{};
  const double h10 = t * (1 - t) * (1 - t), h11 = -t * t * (1 - t), h01 = t * t * (3 - 2 * t);
  const auto add = [&](Eigen::Index frame, double value) {
    weight[static_cast<std::size_t>(frame - first)] += value;
  };
  const auto add_slope = [&](Eigen::Index frame, double factor) {
    if (frame == 0) {
      add(0, -1.5 * factor), add(1, 2.0 * factor), add(2, -0.5 * factor);
    } else if (frame == steps_) {
      add(steps_, 1.5 * factor), add(steps_ - 1, -2.0 * factor), add(steps_ - 2, 0.5 * factor);
    } else {
      add(frame + 1, 0.5 * factor), add(frame - 1, -0.5 * factor);
    }
  };
  add(k, 1.0 - h01);
  add(k + 1, h01);
  add_slope(k, h10);
  add_slope(k + 1, h11);
  for (Eigen::Index i = 0; i < length_.rows(); ++i) {
    const double *r = &length_(i, first), *phi = &angle_(i, first);
    double length = weight[0] * r[0] + weight[1] * r[1] + weight[2] * r[2] + weight[3] * r[3];
    double angle = weight[0] * phi[0] + weight[1] * phi[1] + weight[2] * phi[2] + weight[3] * phi[3];
    if (!length_change_.empty()) {
      length += length_change_[static_cast<std::size_t>(i)].at(u);
      angle += angle_change_[static_cast<std::size_t>(i)].at(u);
    }
    edges(i, column) = length * direction(angle);
  }
}

}  // namespace planar
