// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/coarsening.h"

#include <algorithm>
#include <cmath>

#include "cage/cage_sizes.h"

namespace planar {
namespace {

constexpr double first_step = 0.8;  // of the mean edge: what the shortest edge is raised to in the first pass
constexpr double pass_growth = 1.2;
constexpr double most_strict = 1.5, most = 3.0;  // of the sizes; thin parts keep two rows up to the first
constexpr double longest_edge = 1.7;             // of the shortest that a pass wants
constexpr double least_quality = 0.25;           // of new triangles; 1 is equilateral
constexpr double rim_error = 0.08;               // of the size: what the boundary may be off by
constexpr int smoothings = 3;
constexpr double made_sizes = 0.2;  // of the time: for the sizes and the half-edges

std::vector<int> any_triangle(Eigen::Index n_vertices, const Triangles& triangles) {
  std::vector<int> result(at(n_vertices), -1);
  for (Eigen::Index i = 0; i < triangles.size(); ++i)
    result[at(triangles.data()[i])] = static_cast<int>(i / 3);
  return result;
}

class Coarsening {
 public:
  Coarsening(const Points& dense, const Triangles& triangles, int wished,
             const std::function<bool(double)>& progress);
  Coarse result() const;

 private:
  using Side = HalfEdges::Side;

  const HalfEdges& mesh() const { return work_.mesh(); }
  double mean_edge() const;
  void tell(double share) const;
  void coarsen(int wished);
  void remove_below(double step, bool rows, int wished);
  bool is_crowded(int u, double step) const;
  bool try_removal(int u, double step, bool rows);
  bool keeps_rim(const Side& side) const;

  CarriedMesh work_;
  std::vector<double> size_;
  std::vector<int> rim_next_, rim_last_;  ///< n: the neighbours along the boundary as it was
  const std::function<bool(double)>& progress_;
  int n_alive_ = 0;
};

Coarsening::Coarsening(const Points& dense, const Triangles& triangles, int wished,
                       const std::function<bool(double)>& progress)
    : work_(dense, dense, triangles, any_triangle(dense.rows(), triangles)),
      size_(cage_sizes(dense, mesh(), wished)),
      rim_next_(size_.size(), -1),
      rim_last_(size_.size(), -1),
      progress_(progress) {
  tell(made_sizes);
  for (int v = 0; v < mesh().n_vertices(); ++v) n_alive_ += mesh().out(v) >= 0;
  for (int h = 0; h < 3 * mesh().n_triangles(); ++h) {
    if (mesh().twin(h) >= 0) continue;
    rim_next_[at(mesh().origin(h))] = mesh().target(h);
    rim_last_[at(mesh().target(h))] = mesh().origin(h);
  }
  coarsen(wished);
  for (int round = 0; round < smoothings; ++round) {
    for (int v = 0; v < mesh().n_vertices(); ++v) {
      if (mesh().out(v) >= 0 && !mesh().is_boundary(v)) work_.smooth(v, size_);
    }
    work_.flip_to_delaunay(true);
  }
}

void Coarsening::tell(double share) const {
  if (progress_ && !progress_(share)) throw Cancelled();
}

double Coarsening::mean_edge() const {
  double sum = 0.0;
  for (int h = 0; h < 3 * mesh().n_triangles(); ++h) {
    const int a = mesh().origin(h), b = mesh().target(h);
    sum += work_.length(a, b) / std::min(size_[at(a)], size_[at(b)]);
  }
  return sum / (3 * mesh().n_triangles());
}

void Coarsening::coarsen(int wished) {
  double step = std::min(1.0, first_step * mean_edge());
  const double all = std::log(n_alive_ / static_cast<double>(wished));
  for (const bool rows : {true, false}) {
    for (; n_alive_ > wished && step <= (rows ? most_strict : most); step *= pass_growth) {
      tell(made_sizes + (1.0 - made_sizes) * (1.0 - std::log(n_alive_ / static_cast<double>(wished)) / all));
      remove_below(step, rows, wished);
      work_.flip_to_delaunay(rows);
    }
    step = std::min(step, 1.0);
  }
}

/// Removes vertices until no two are nearer to each other than `step` times the sizes, if they can be.
void Coarsening::remove_below(double step, bool rows, int wished) {
  for (int u = 0; u < mesh().n_vertices() && n_alive_ > wished; ++u) {
    if (mesh().out(u) < 0 || mesh().is_fixed(u) || !is_crowded(u, step)) continue;
    if (try_removal(u, step, rows)) --n_alive_;
  }
}

bool Coarsening::is_crowded(int u, double step) const {
  bool crowded = false;
  mesh().for_sides(u, [&](const Side& side) {
    crowded = crowded || work_.length(u, side.v) < step * std::min(size_[at(u)], size_[at(side.v)]);
  });
  return crowded;
}

/// Moves u into the neighbour for which the worst of the new triangles is best.
bool Coarsening::try_removal(int u, double step, bool rows) {
  const bool on_rim = mesh().is_boundary(u);
  double worst = 1.0, longest = 0.0;
  mesh().for_fan(u, [&](int h) {
    worst = std::min(worst, work_.quality_of(h / 3));
    longest = std::max(longest, work_.length(u, mesh().target(h)));
  });
  const double needed = std::min(least_quality, worst);
  Side best{u, -1, -1, -1};
  double best_quality = 0.0;
  mesh().for_sides(u, [&](const Side& side) {
    const int v = side.v;
    if (mesh().is_fixed(v) || (on_rim && side.there >= 0 && side.back >= 0)) return;
    double least = 1.0;
    mesh().for_fan(u, [&](int h) {
      const int a = mesh().target(h), b = mesh().origin(HalfEdges::previous(h));
      if (a == v || b == v || !(least > best_quality)) return;
      least =
          std::min(least, CarriedMesh::quality(work_.at_vertex(v), work_.at_vertex(a), work_.at_vertex(b)));
    });
    if (!(least > best_quality) || !(least >= needed)) return;
    const bool makes_chords = rows && !on_rim && mesh().is_boundary(v);
    // The tips of the triangles that go are neighbours of v as they are.
    const int tip = side.there >= 0 ? mesh().origin(HalfEdges::previous(side.there)) : -1;
    const int other_tip = side.back >= 0 ? mesh().origin(HalfEdges::previous(side.back)) : -1;
    bool fits = true;
    mesh().for_sides(u, [&](const Side& other) {
      const int x = other.v;
      if (x == v || x == tip || x == other_tip) return;
      if (makes_chords && mesh().is_boundary(x)) fits = false;
      const double limit = longest_edge * step * std::min(size_[at(v)], size_[at(x)]);
      if (work_.length(v, x) > std::max(limit, longest)) fits = false;
    });
    if (!fits || !work_.can_collapse(side) || (on_rim && !keeps_rim(side))) return;
    best = side;
    best_quality = least;
  });
  if (best.v < 0) return false;
  work_.collapse(best);
  return true;
}

/// Whether the boundary as it was lies near to the side that will take the place of two.
bool Coarsening::keeps_rim(const Side& side) const {
  const bool forward = side.there >= 0;
  const std::vector<int>& onward = forward ? rim_next_ : rim_last_;
  const std::vector<int>& backward = forward ? rim_last_ : rim_next_;
  int other = -1;
  mesh().for_sides(side.u, [&](const Side& s) {
    if (forward ? s.there < 0 : s.back < 0) other = s.v;
  });
  const Eigen::RowVector2d a = work_.at_vertex(other), way = work_.at_vertex(side.v) - a;
  const double limit = rim_error * size_[at(side.u)] * way.norm();
  const auto is_near = [&](int v) {
    const Eigen::RowVector2d p = work_.dense().row(v) - a;
    return std::abs(way.x() * p.y() - way.y() * p.x()) <= limit;
  };
  for (int v = side.u; v != side.v; v = onward[at(v)]) {
    if (!is_near(v)) return false;
  }
  for (int v = side.u; v != other; v = backward[at(v)]) {
    if (!is_near(v)) return false;
  }
  return true;
}

Coarse Coarsening::result() const {
  Coarse result;
  std::vector<int> number(size_.size(), -1);
  for (int v = 0; v < mesh().n_vertices(); ++v) {
    if (mesh().out(v) < 0) continue;
    number[at(v)] = static_cast<int>(result.origins.size());
    result.origins.push_back({v, -1, -1});
    result.sizes.push_back(size_[at(v)]);
  }
  result.points.resize(static_cast<Eigen::Index>(result.origins.size()), 2);
  for (std::size_t i = 0; i < result.origins.size(); ++i)
    result.points.row(static_cast<Eigen::Index>(i)) = work_.at_vertex(result.origins[i].source);
  result.triangles = work_.triangles(number);
  result.triangle_of = work_.owners();
  return result;
}

}  // namespace

Coarse coarsened(const Points& points, const Triangles& triangles, int wished,
                 const std::function<bool(double)>& progress) {
  return Coarsening(points, triangles, wished, progress).result();
}

}  // namespace planar
