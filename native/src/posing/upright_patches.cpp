// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/upright_patches.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "base/disjoint_sets.h"
#include "base/index.h"
#include "posing/hold_method.h"

namespace planar {

namespace {

struct Attempt {
  int rings;  ///< round the triangles
  int steps;  ///< of Newton; most patches need 10 to 40 to come right
};
constexpr std::array<Attempt, 3> attempts{{{3, 20}, {8, 40}, {4, 80}}};
constexpr int most_free = 4000;  // vertices: beyond, a move would be felt to stop
/// Of the vertices round a patch, beside energies of area: it moves them by 1e-5 of an edge.
constexpr double held = 1e6;

/// The vertices within so many rings of some triangles, but for the fixed ones.
std::vector<char> vertices_near(const Triangles& triangles, const std::vector<int>& rows, int n_rings,
                                const std::vector<char>& fixed) {
  std::vector<char> near(fixed.size());
  for (const int t : rows) {
    for (int c = 0; c < 3; ++c) near[at(triangles(t, c))] = 1;
  }
  for (int ring = 1; ring < n_rings; ++ring) {
    std::vector<char> wider = near;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      const int* corner = triangles.data() + 3 * t;
      if (!near[at(corner[0])] && !near[at(corner[1])] && !near[at(corner[2])]) continue;
      for (int c = 0; c < 3; ++c) wider[at(corner[c])] = 1;
    }
    std::swap(near, wider);
  }
  for (std::size_t v = 0; v < near.size(); ++v) near[v] = near[v] && !fixed[v];
  return near;
}

/// Triangles with a vertex that is free, as a mesh of their own.
struct Patch {
  Patch(const Triangles& triangles, const std::vector<char>& free) {
    std::vector<int> number(free.size(), -1);
    for (int t = 0; t < static_cast<int>(triangles.rows()); ++t) {
      const int* corner = triangles.data() + 3 * t;
      if (!free[at(corner[0])] && !free[at(corner[1])] && !free[at(corner[2])]) continue;
      rows.push_back(t);
      for (int c = 0; c < 3; ++c) {
        if (number[at(corner[c])] >= 0) continue;
        number[at(corner[c])] = static_cast<int>(vertices.size());
        if (!free[at(corner[c])]) around.push_back(number[at(corner[c])]);
        vertices.push_back(corner[c]);
      }
    }
    own = triangles(rows, Eigen::all);
    for (int& corner : own.reshaped()) corner = number[at(corner)];
  }

  std::vector<int> rows, vertices;  ///< of the whole mesh
  std::vector<int> around;          ///< of its own vertices those that are not free
  Triangles own;
};

/// Takes the free vertices of the patches to where their rest energy is least, wherever that leaves less of
/// the triangles turned over. Those vertices are added to `moved`.
void settle_patches(const Patch& patch, const Points& rest, const Orientation& orientation,
                    const Eigen::RowVector2d& centre, const Eigen::VectorXd& stiffness, int steps, Points& x,
                    std::vector<int>& moved) {
  const Points own_rest = rest(patch.vertices, Eigen::all);
  Eigen::VectorXd factors;
  if (stiffness.size() != 0) factors = stiffness(patch.rows);
  const Orientation upright(own_rest.rowwise() + centre, patch.own, orientation.flat()(patch.rows), centre);
  HoldMethod hold(own_rest, patch.own, upright, factors);
  const auto n_around = static_cast<Eigen::Index>(patch.around.size());
  HandleSet set;
  set.handles =
      Handles::at_vertices(Eigen::Map<const Eigen::VectorXi>(patch.around.data(), n_around), own_rest.rows());
  set.strength.setConstant(n_around, held);
  set.patch.resize(patch.around.size());
  hold.set_handles(set);
  hold.reset();
  const Points before = x(patch.vertices, Eigen::all);
  Points after = before;
  Report report;
  hold.settle_within(steps, {}, set.handles.positions(before), after, report);
  for (const int v : patch.around) after.row(v) = before.row(v);

  DisjointSets connected(patch.vertices.size());
  std::vector<int> fewer(patch.vertices.size());  // by representative
  for (Eigen::Index t = 0; t < patch.own.rows(); ++t) {
    connected.join(patch.own(t, 0), patch.own(t, 1));
    connected.join(patch.own(t, 0), patch.own(t, 2));
  }
  const Flags were = upright.flipped(before), are = upright.flipped(after);
  for (Eigen::Index t = 0; t < patch.own.rows(); ++t)
    fewer[at(connected.find(patch.own(t, 0)))] += static_cast<int>(were[t]) - static_cast<int>(are[t]);
  for (int v = 0; v < static_cast<int>(patch.vertices.size()); ++v) {
    if (fewer[at(connected.find(v))] <= 0) continue;
    x.row(patch.vertices[at(v)]) = after.row(v);
    moved.push_back(patch.vertices[at(v)]);
  }
}

}  // namespace

std::vector<int> turn_upright(const Points& rest, const Orientation& orientation,
                              const Eigen::RowVector2d& centre, const Eigen::VectorXd& stiffness,
                              const std::vector<char>& fixed, const std::vector<int>& suspects, Points& x) {
  const Triangles& triangles = orientation.triangles();
  std::vector<int> moved;
  for (const Attempt& attempt : attempts) {
    std::vector<int> flipped;
    std::copy_if(suspects.begin(), suspects.end(), std::back_inserter(flipped),
                 [&](int t) { return orientation.is_flipped(x, t); });
    if (flipped.empty()) break;
    const std::vector<char> free = vertices_near(triangles, flipped, attempt.rings, fixed);
    if (std::count(free.begin(), free.end(), char{1}) > most_free) break;
    try {
      settle_patches(Patch(triangles, free), rest, orientation, centre, stiffness, attempt.steps, x, moved);
    } catch (const SolveError&) {  // what is turned over stays
    }
  }
  std::sort(moved.begin(), moved.end());
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  return moved;
}

}  // namespace planar
