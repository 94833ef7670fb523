// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/sequence.h"

#include <algorithm>
#include <string>

#include "base/checks.h"
#include "inbetween/frame_assembler.h"
#include "inbetween/inbetween_input.h"
#include "parallel/thread_team.h"

namespace planar {

using Complex = std::complex<double>;

void require_frames(const std::vector<Points>& frames) {
  if (frames.empty()) throw std::invalid_argument("frames is empty");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const std::string name = "frames[" + std::to_string(k) + "]";
    require_rows(name.c_str(), frames[k].rows(), frames[0].rows(), "vertex of frames[0]");
    require_finite(name.c_str(), frames[k]);
  }
}

std::vector<Points> assembled(const EdgeGraph& graph, const std::vector<Points>& references,
                              std::size_t n_frames,
                              const std::function<void(std::size_t, ComplexRows&, Eigen::Index)>& edges_of,
                              const std::function<std::vector<Complex>(std::size_t)>& centres_of) {
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
    for (std::size_t k = 0; k < count; ++k) edges_of(first + k, edges, static_cast<Eigen::Index>(k));
    assembler.assemble(edges, 0, points);
    for (std::size_t k = 0; k < count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      std::vector<Complex> shift = centres_of(first + k);
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

}  // namespace planar
