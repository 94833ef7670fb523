// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/motion.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/checks.h"
#include "base/complex_product.h"
#include "inbetween/edge_turns.h"
#include "inbetween/frame_assembler.h"
#include "inbetween/inbetween_input.h"
#include "parallel/thread_team.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

/// Of the diagonal: edges that are shorter have no direction in numbers rounded to float32.
constexpr double no_length = 1e-7;

Complex place(const Points& x, Eigen::Index v) { return {x(v, 0), x(v, 1)}; }

void require_frames(const std::vector<Points>& frames) {
  if (frames.empty()) throw std::invalid_argument("frames is empty");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const std::string name = "frames[" + std::to_string(k) + "]";
    require_rows(name.c_str(), frames[k].rows(), frames[0].rows(), "vertex of frames[0]");
    require_finite(name.c_str(), frames[k]);
  }
}

/// The similarity z -> s z that takes the edges of one shape nearest to those of another.
Complex similarity(const EdgeGraph& graph, const Points& from, const Points& to) {
  Complex sum = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const Complex e = graph.vector(i, from);
    sum += std::conj(e) * graph.vector(i, to);
    size += std::norm(e);
  }
  return size > 0.0 ? sum / size : 1.0;
}

/// The means of the parts' vertices; isolated vertices are parts of their own, behind the others.
class Centroids {
 public:
  explicit Centroids(const EdgeGraph& graph)
      : group_(graph.part), count_(static_cast<std::size_t>(graph.n_parts)) {
    for (int& group : group_) {
      if (group == -1) {
        group = static_cast<int>(count_.size());
        count_.push_back(0.0);
      }
      count_[static_cast<std::size_t>(group)] += 1.0;
    }
  }

  std::vector<Complex> of(const auto& place_of) const {
    std::vector<Complex> sum(count_.size());
    for (std::size_t v = 0; v < group_.size(); ++v) {
      sum[static_cast<std::size_t>(group_[v])] += place_of(static_cast<Eigen::Index>(v));
    }
    for (std::size_t group = 0; group < sum.size(); ++group) sum[group] /= count_[group];
    return sum;
  }

  std::size_t group(Eigen::Index v) const {
    return static_cast<std::size_t>(group_[static_cast<std::size_t>(v)]);
  }

 private:
  std::vector<int> group_;
  std::vector<double> count_;
};

/// Assembles frames from edge_of(edge, frame), with each part's centroid at centre_of(frame)[part].
std::vector<Points> assembled(const EdgeGraph& graph, const std::vector<Points>& references,
                              std::size_t n_frames, const auto& edge_of, const auto& centre_of) {
  constexpr Eigen::Index lanes = FrameAssembler::lanes;
  FrameAssembler assembler(graph);
  assembler.factorize(frozen_weights(graph, references));
  const Centroids centroids(graph);
  std::vector<Points> result(n_frames);
  ThreadTeam team(0);
  team.run((n_frames + lanes - 1) / lanes, [&](std::size_t pass, std::size_t) {
    const std::size_t first = pass * lanes, count = std::min<std::size_t>(lanes, n_frames - first);
    ComplexRows edges = ComplexRows::Zero(static_cast<Eigen::Index>(graph.edges.size()), lanes);
    ComplexRows points(graph.n_vertices, lanes);
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      for (std::size_t k = 0; k < count; ++k) {
        edges(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = edge_of(i, first + k);
      }
    }
    assembler.assemble(edges, 0, points);
    for (std::size_t k = 0; k < count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      std::vector<Complex> shift = centre_of(first + k);
      const std::vector<Complex> here = centroids.of([&](Eigen::Index v) { return points(v, column); });
      for (std::size_t group = 0; group < shift.size(); ++group) shift[group] -= here[group];
      Points& frame = result[first + k];
      frame.resize(graph.n_vertices, 2);
      for (Eigen::Index v = 0; v < frame.rows(); ++v) {
        const Complex p = points(v, column) + shift[centroids.group(v)];
        frame.row(v) << p.real(), p.imag();
      }
      if (!frame.allFinite()) throw SolveError("the frames overflow: are their numbers sensible?");
    }
  });
  return result;
}

std::vector<Points> transfer(const std::vector<Points>& frames, const Points& target,
                             const EdgeGraph& graph) {
  require_rows("target", target.rows(), frames[0].rows(), "vertex of frames[0]");
  require_finite("target", target);
  const Complex whole = similarity(graph, frames[0], target);
  const double shortest = no_length * diagonal_of({frames[0]});
  const auto edge_of = [&](std::size_t i, std::size_t k) {
    const Complex first = graph.vector(i, frames[0]), own = graph.vector(i, target);
    // An edge without length has no similarity of its own.
    const Complex s = std::abs(first) > shortest ? own / first : whole;
    return own + product(s, graph.vector(i, frames[k]) - first);
  };
  const Centroids centroids(graph);
  const auto centre_of = [&](std::size_t k) {
    const auto of = [&](const Points& x) {
      return centroids.of([&x](Eigen::Index v) { return place(x, v); });
    };
    std::vector<Complex> centre = of(target);
    const std::vector<Complex> first = of(frames[0]), now = of(frames[k]);
    for (std::size_t group = 0; group < centre.size(); ++group) {
      centre[group] += product(whole, now[group] - first[group]);
    }
    return centre;
  };
  return assembled(graph, {target}, frames.size(), edge_of, centre_of);
}

/// The changes of the edges and parts in an edited frame.
struct Change {
  std::size_t frame;
  const Points* shape;
  Eigen::ArrayXd scale, turn;  ///< of an edge: logarithm of the scale, angle
  std::vector<Complex> shift;  ///< of the centroids
};

std::vector<Points> edit(const std::vector<Points>& frames, const std::vector<FrameEdit>& edits,
                         const EdgeGraph& graph) {
  const auto n_edges = static_cast<Eigen::Index>(graph.edges.size());
  const Centroids centroids(graph);
  const auto centre = [&](const Points& x) {
    return centroids.of([&x](Eigen::Index v) { return place(x, v); });
  };
  const EdgeTurns unwrapped(graph);
  std::vector<Change> changes;
  for (std::size_t row = 0; row < edits.size(); ++row) {
    const auto& [number, shape] = edits[row];
    if (number < 0 || static_cast<std::size_t>(number) >= frames.size()) {
      throw std::invalid_argument(row_of("edits", static_cast<Eigen::Index>(row)) + "frame " +
                                  std::to_string(number) + " is out of range, there are " +
                                  std::to_string(frames.size()) + " frames");
    }
    const std::string name = "edits[" + std::to_string(row) + "].shape";
    require_rows(name.c_str(), shape.rows(), frames[0].rows(), "vertex of frames[0]");
    require_finite(name.c_str(), shape);
    const auto frame = static_cast<std::size_t>(number);
    Change change{frame, &shape, Eigen::ArrayXd::Zero(n_edges),
                  unwrapped.between(frames[frame], shape).array(), centre(shape)};
    const std::vector<Complex> before = centre(frames[frame]);
    const double shortest = no_length * diagonal_of({frames[frame], shape});
    for (std::size_t group = 0; group < before.size(); ++group) change.shift[group] -= before[group];
    for (Eigen::Index i = 0; i < n_edges; ++i) {
      const double from = std::abs(graph.vector(static_cast<std::size_t>(i), frames[frame])),
                   to = std::abs(graph.vector(static_cast<std::size_t>(i), shape));
      if (from > shortest && to > shortest) change.scale[i] = std::log(to / from);
    }
    changes.push_back(std::move(change));
  }
  if (changes.empty()) return frames;
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.frame < b.frame; });
  for (std::size_t i = 1; i < changes.size(); ++i) {
    if (changes[i].frame == changes[i - 1].frame) {
      throw std::invalid_argument("edits: frame " + std::to_string(changes[i].frame) + " is edited twice");
    }
  }

  /// The edits around a frame, and how far it is from the first to the second.
  struct Between {
    const Change *a, *b;
    double share;
  };
  const auto around = [&changes](std::size_t k) -> Between {
    if (k <= changes.front().frame) return {&changes.front(), &changes.front(), 0.0};
    if (k >= changes.back().frame) return {&changes.back(), &changes.back(), 0.0};
    const auto b =
        std::upper_bound(changes.begin(), changes.end(), k,
                         [](std::size_t frame, const Change& change) { return frame < change.frame; });
    const auto a = b - 1;
    return {&*a, &*b, static_cast<double>(k - a->frame) / static_cast<double>(b->frame - a->frame)};
  };
  const auto edge_of = [&](std::size_t i, std::size_t k) {
    const auto [a, b, share] = around(k);
    const auto row = static_cast<Eigen::Index>(i);
    const double scale = (1.0 - share) * a->scale[row] + share * b->scale[row];
    const double turn = (1.0 - share) * a->turn[row] + share * b->turn[row];
    return product(std::polar(std::exp(scale), turn), graph.vector(i, frames[k]));
  };
  const auto centre_of = [&](std::size_t k) {
    const auto [a, b, share] = around(k);
    std::vector<Complex> result = centre(frames[k]);
    for (std::size_t group = 0; group < result.size(); ++group) {
      result[group] += (1.0 - share) * a->shift[group] + share * b->shift[group];
    }
    return result;
  };
  std::vector<Points> references;
  references.reserve(changes.size());
  for (const Change& change : changes) references.push_back(*change.shape);
  std::vector<Points> result = assembled(graph, references, frames.size(), edge_of, centre_of);
  // Edges that an edit gives or takes their length have no similarity; what was given stays to the bit.
  for (const Change& change : changes) result[change.frame] = *change.shape;
  return result;
}

}  // namespace

std::vector<Points> transfer_motion(const std::vector<Points>& frames, const Points& target,
                                    const Triangles& triangles) {
  require_frames(frames);
  return transfer(frames, target, EdgeGraph(frames[0].rows(), triangles));
}

std::vector<Points> transfer_motion(const std::vector<Points>& frames, const Points& target,
                                    const Edges& edges) {
  require_frames(frames);
  return transfer(frames, target, EdgeGraph(frames[0].rows(), edges));
}

std::vector<Points> edit_sequence(const std::vector<Points>& frames, const std::vector<FrameEdit>& edits,
                                  const Triangles& triangles) {
  require_frames(frames);
  return edit(frames, edits, EdgeGraph(frames[0].rows(), triangles));
}

std::vector<Points> edit_sequence(const std::vector<Points>& frames, const std::vector<FrameEdit>& edits,
                                  const Edges& edges) {
  require_frames(frames);
  return edit(frames, edits, EdgeGraph(frames[0].rows(), edges));
}

}  // namespace planar
