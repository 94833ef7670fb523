// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/sequence_edit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/checks.h"
#include "base/complex_product.h"
#include "inbetween/edge_turns.h"
#include "inbetween/inbetween_input.h"
#include "inbetween/sequence.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

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
                  unwrapped.between(frames[frame], shape).array(), centroids.of(shape)};
    const std::vector<Complex> before = centroids.of(frames[frame]);
    const double shortest = no_length * size_of({frames[frame], shape});
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
  const auto edges_of = [&](std::size_t k, ComplexRows& edges, Eigen::Index column) {
    const auto [a, b, share] = around(k);
    for (Eigen::Index i = 0; i < n_edges; ++i) {
      const double scale = (1.0 - share) * a->scale[i] + share * b->scale[i];
      const double turn = (1.0 - share) * a->turn[i] + share * b->turn[i];
      edges(i, column) =
          product(std::polar(std::exp(scale), turn), graph.vector(static_cast<std::size_t>(i), frames[k]));
    }
  };
  const auto centres_of = [&](std::size_t k) {
    const auto [a, b, share] = around(k);
    std::vector<Complex> result = centroids.of(frames[k]);
    for (std::size_t group = 0; group < result.size(); ++group) {
      result[group] += (1.0 - share) * a->shift[group] + share * b->shift[group];
    }
    return result;
  };
  std::vector<Points> references;
  references.reserve(changes.size());
  for (const Change& change : changes) references.push_back(*change.shape);
  std::vector<Points> result = assembled(graph, references, frames.size(), edges_of, centres_of);
  // Edges that an edit gives or takes their length have no similarity; what was given stays to the bit.
  for (const Change& change : changes) result[change.frame] = *change.shape;
  return result;
}

}  // namespace

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
