// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/part_condition.h"

#include "inbetween/blended_triangles.h"
#include "mesh/orientation.h"

namespace planar {

namespace {

constexpr double most_strain = 3.0;  // of a triangle: it is about to collapse

std::size_t part_of(const EdgeGraph& graph, std::size_t t) {
  return static_cast<std::size_t>(
      graph.part[static_cast<std::size_t>(graph.triangles(static_cast<Eigen::Index>(t), 0))]);
}

}  // namespace

std::vector<PartCondition> conditions_of_parts(const EdgeGraph& graph, const Points& from, const Points& to,
                                               const std::vector<Points>& frames, const Eigen::VectorXd& u,
                                               ThreadTeam& team) {
  const auto n_parts = static_cast<std::size_t>(graph.n_parts);
  const BlendedTriangles blended(from, to, graph.triangles);
  const Orientation upright(from, graph.triangles, blended.flat());
  std::vector<std::vector<char>> fails(frames.size(), std::vector<char>(n_parts));
  team.run(frames.size(), [&](std::size_t k, std::size_t) {
    std::vector<double> area;
    upright.measure(frames[k], area);
    for (std::size_t t = 0; t < area.size(); ++t) {
      char& failing = fails[k][part_of(graph, t)];
      failing = failing || area[t] < 0.0 ||
                blended.strain(static_cast<int>(t), frames[k], u[static_cast<Eigen::Index>(k)]) > most_strain;
    }
  });
  std::vector<PartCondition> result(n_parts, PartCondition::sound);
  for (const std::vector<char>& frame : fails) {
    for (std::size_t part = 0; part < n_parts; ++part) {
      if (frame[part]) result[part] = PartCondition::failing;
    }
  }
  std::vector<double> area;
  upright.measure(to, area);
  for (std::size_t t = 0; t < area.size(); ++t) {
    if (area[t] < 0.0) result[part_of(graph, t)] = PartCondition::hopeless;
  }
  return result;
}

Triangles triangles_of_parts(const EdgeGraph& graph, const std::vector<PartCondition>& conditions,
                             PartCondition wanted) {
  std::vector<int> rows;
  for (Eigen::Index t = 0; t < graph.triangles.rows(); ++t) {
    if (conditions[part_of(graph, static_cast<std::size_t>(t))] == wanted) {
      rows.push_back(static_cast<int>(t));
    }
  }
  return graph.triangles(rows, Eigen::all);
}

}  // namespace planar
