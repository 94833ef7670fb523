// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/transfer.h"

#include <cmath>

#include "base/checks.h"
#include "base/complex_product.h"
#include "inbetween/inbetween_input.h"
#include "inbetween/sequence.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

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

std::vector<Points> transfer(const std::vector<Points>& frames, const Points& shape, const EdgeGraph& graph) {
  require_rows("shape", shape.rows(), frames[0].rows(), "vertex of frames[0]");
  require_finite("shape", shape);
  const Complex whole = similarity(graph, frames[0], shape);
  const double shortest = no_length * size_of({frames[0]});
  const auto edges_of = [&](std::size_t k, ComplexRows& edges, Eigen::Index column) {
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      const Complex first = graph.vector(i, frames[0]), own = graph.vector(i, shape);
      // An edge without length has no similarity of its own.
      const Complex s = std::abs(first) > shortest ? own / first : whole;
      edges(static_cast<Eigen::Index>(i), column) = own + product(s, graph.vector(i, frames[k]) - first);
    }
  };
  const Centroids centroids(graph);
  const auto centres_of = [&](std::size_t k) {
    std::vector<Complex> centre = centroids.of(shape);
    const std::vector<Complex> first = centroids.of(frames[0]), now = centroids.of(frames[k]);
    for (std::size_t group = 0; group < centre.size(); ++group) {
      centre[group] += product(whole, now[group] - first[group]);
    }
    return centre;
  };
  return assembled(graph, {shape}, frames.size(), edges_of, centres_of);
}

}  // namespace

std::vector<Points> transfer_motion(const std::vector<Points>& frames, const Points& shape,
                                    const Triangles& triangles) {
  require_frames(frames);
  return transfer(frames, shape, EdgeGraph(frames[0].rows(), triangles));
}

std::vector<Points> transfer_motion(const std::vector<Points>& frames, const Points& shape,
                                    const Edges& edges) {
  require_frames(frames);
  return transfer(frames, shape, EdgeGraph(frames[0].rows(), edges));
}

}  // namespace planar
