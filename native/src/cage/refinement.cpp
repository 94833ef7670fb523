// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planar {
namespace {

constexpr double pin_grading = 0.4;
constexpr double worst_grading = 1.2;  // beyond, hardly an edge is long enough to be halved
constexpr double room = 0.5;           // of the vertices: how many more there may be
constexpr double too_long = 1.4;       // of the wished length
constexpr int fewest = 3;              // dense vertices on both sides of an edge that is halved
constexpr int most_sweeps = 40;

struct Spot {
  Eigen::RowVector2d place;
  double least;  ///< length of the dense edges
};

}  // namespace

Coarse refined_near(const Points& dense, const Coarse& coarse, const std::vector<int>& vertices) {
  CarriedMesh work(dense, coarse.points, coarse.triangles, coarse.triangle_of);
  std::vector<Spot> spots;
  double wanted = 0.0;  // vertices, times the squared pin_grading
  for (const int v : vertices) {
    const int t = coarse.triangle_of[at(v)];
    if (t < 0) continue;
    const double least = std::sqrt(work.area_of(t) / (vertex_cell * std::max(1, work.count_in(t))));
    spots.push_back({dense.row(v), least});
    const double size = coarse.sizes[at(coarse.triangles(t, 0))];
    wanted += 2.0 * std::numbers::pi / vertex_cell * std::max(0.0, std::log(size / least));
  }
  const double affordable = room * static_cast<double>(coarse.points.rows());
  const double growth = std::max(pin_grading, std::sqrt(wanted / affordable));
  Coarse result = coarse;
  if (spots.empty() || growth > worst_grading) return result;

  const auto wished = [&](const Eigen::RowVector2d& p, double otherwise) {
    for (const Spot& spot : spots)
      otherwise = std::min(otherwise, std::max(spot.least, growth * (spot.place - p).norm()));
    return otherwise;
  };
  const HalfEdges& mesh = work.mesh();
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool any = false;
    const int last = 3 * mesh.n_triangles();
    for (int h = 0; h < last; ++h) {
      const int a = mesh.origin(h), b = mesh.target(h);
      if (mesh.twin(h) > h) continue;
      const double length = work.length(a, b);
      const double now = std::max(result.sizes[at(a)], result.sizes[at(b)]);
      const double size = wished(0.5 * (work.at_vertex(a) + work.at_vertex(b)), now);
      if (!(size < now) || length <= too_long * size) continue;
      // Where no dense vertex depends on the new one nothing would say where it is.
      const int beyond = mesh.twin(h) < 0 ? 0 : work.count_in(mesh.twin(h) / 3);
      if (work.count_in(h / 3) + beyond < fewest) continue;
      work.split(h);
      result.sizes.push_back(size);
      result.origins.push_back({-1, a, b});
      any = true;
    }
    if (!any) break;
    work.flip_to_delaunay(true);
    for (int v = static_cast<int>(coarse.points.rows()); v < mesh.n_vertices(); ++v) {
      if (!mesh.is_boundary(v)) work.smooth(v, result.sizes);
    }
  }
  result.points.resize(mesh.n_vertices(), 2);
  std::vector<int> number;
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    result.points.row(v) = work.at_vertex(v);
    number.push_back(v);
  }
  result.triangles = work.triangles(number);
  result.triangle_of = work.owners();
  return result;
}

}  // namespace planar
