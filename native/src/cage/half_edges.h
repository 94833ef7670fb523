// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/index.h"
#include "planar/types.h"

namespace planar {

/// The triangles of a flat mesh, all counter-clockwise, as half-edges that are collapsed and flipped in
/// place. Half-edge 3t + c goes from corner c of triangle t to the next one; -1 is none.
///
/// Vertices at which the mesh is no surface that lies flat are `fixed`: those of edges with more than two
/// triangles or with two on one side, and those in which pieces meet that share no edge there. Their
/// triangles keep them, and they stay where they are.
class HalfEdges {
 public:
  HalfEdges(const Points& points, const Triangles& triangles);

  int n_triangles() const { return static_cast<int>(corner_.size() / 3); }
  int n_vertices() const { return static_cast<int>(out_.size()); }
  bool is_alive(int triangle) const { return corner_[3 * at(triangle)] >= 0; }
  /// Three corners of a triangle that is alive.
  const int* corners(int triangle) const { return corner_.data() + 3 * at(triangle); }

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int origin(int h) const { return corner_[at(h)]; }
  int target(int h) const { return corner_[at(next(h))]; }
  int twin(int h) const { return twin_[at(h)]; }

  /// One that goes out of a vertex, -1 if it is in no triangle; on the boundary the one with no twin.
  int out(int vertex) const { return out_[at(vertex)]; }
  bool is_fixed(int vertex) const { return fixed_[at(vertex)]; }
  /// Fixed ones count.
  bool is_boundary(int vertex) const { return fixed_[at(vertex)] || twin(out(vertex)) < 0; }

  /// Calls visit(h) for the half-edges out of a vertex that is not fixed, counter-clockwise.
  void for_fan(int vertex, const auto& visit) const {
    const int first = out(vertex);
    int h = first;
    do {
      visit(h);
      h = twin(previous(h));
    } while (h >= 0 && h != first);
  }

  /// An edge seen from one of its ends, u: the half-edges from u to v and back, one of which may be missing.
  struct Side {
    int u, v, there, back;
  };
  /// Calls visit(side) for the edges of a vertex that is not fixed, counter-clockwise.
  void for_sides(int vertex, const auto& visit) const {
    int last = -1;
    for_fan(vertex, [&](int h) {
      visit(Side{vertex, target(h), h, twin(h)});
      last = previous(h);
    });
    if (twin(last) < 0) visit(Side{vertex, origin(last), -1, last});
  }

  /// Whether u can be moved into v without a change of what the mesh is like: parts, holes, boundary. Neither
  /// is fixed.
  bool can_collapse(const Side& side);
  /// Moves u into v. \pre can_collapse
  void collapse(const Side& side);

  /// Whether the edge of h can be replaced by the one between the opposite corners.
  bool can_flip(int h) const;
  void flip(int h);

  /// Puts a new vertex onto the edge of h, and gives its number, the next one.
  int split(int h);

 private:
  void put(int first, const std::array<int, 3>& corner, const std::array<int, 3>& twins);
  void turn_counter_clockwise(const Points& points);
  void join_twins();
  void find_fixed();
  void set_out(int vertex, int h);

  std::vector<int> corner_, twin_;  ///< 3m; -1 in triangles that are gone
  std::vector<int> out_;            ///< n
  std::vector<char> fixed_;
  std::vector<int> seen_;  ///< n: marks of the pass `pass_`
  int pass_ = 0;
  std::vector<int> fan_;  ///< of the collapse under way
};

}  // namespace planar
