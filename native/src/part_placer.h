// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "edge_graph.h"

namespace planar {

/// Sets assembled frames, which have no place of their own, where they belong: each part's anchor, the mean
/// of some of its vertices, is on its path from one key to the next; isolated vertices go straight.
class PartPlacer {
 public:
  /// What is chosen between two keys, one value a part.
  struct Course {
    Eigen::VectorXd turns;      ///< radians by which the part is turned as it goes
    Eigen::VectorXd arc_turns;  ///< radians of the anchor's arc; 0: straight
  };

  /// \param anchor vertices; parts without any are held at their centroid
  /// \throw std::invalid_argument naming the row of `anchor` that is out of range
  PartPlacer(const EdgeGraph& graph, const Eigen::VectorXi& anchor);

  /// The frame at u from 0 (`from`) to 1 (`to`): a column of `points` turned by u·turns.
  Points place(const ComplexRows& points, Eigen::Index column, const Points& from, const Points& to, double u,
               const Course& course) const;

  /// Shifts the parts of x so that their anchors are where they are in `placed`.
  void hold_anchors(const Points& placed, Points& x) const;

  /// The arcs of parts that turn by `turns`; near a whole turn, where the circle would be without bounds, by
  /// what differs from it.
  static Eigen::VectorXd arcs(const Eigen::VectorXd& turns);

 private:
  const EdgeGraph& graph_;
  std::vector<std::vector<int>> anchors_;  ///< of a part, never empty
};

}  // namespace planar
