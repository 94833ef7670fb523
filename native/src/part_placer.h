// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "edge_graph.h"
#include "key_slopes.h"

namespace planar {

/// Sets assembled frames between two keys, which have no place of their own, where they belong: each part's
/// anchor, the mean of some of its vertices, is on its path from one key to the next; isolated vertices go
/// straight.
class PartPlacer {
 public:
  /// What is chosen between two keys, one value a part.
  struct Course {
    Eigen::VectorXd turns;      ///< radians by which the part is turned as it goes
    Eigen::VectorXd arc_turns;  ///< radians of the anchor's arc; 0: straight
  };

  /// \param from, to the keys
  /// \param anchor vertices in range; parts without any are held at their centroid
  PartPlacer(const EdgeGraph& graph, const Points& from, const Points& to, const Eigen::VectorXi& anchor,
             Course course);

  /// The frame at u, 0 at the first key and 1 at the second, or beyond them: a column of `points` turned by
  /// u·turns.
  Points place(const ComplexRows& points, Eigen::Index column, double u) const;

  /// Shifts the parts of x so that their anchors are where they are in `placed`.
  void hold_anchors(const Points& placed, Points& x) const;

  /// Has turns and paths meet the key between two transitions with the same velocities. Where the anchors of
  /// a part differ in the two, its path is left as it is.
  static void join(PartPlacer& before, PartPlacer& after, KeyGaps gaps);

  /// The arcs of parts that turn by `turns`; near a whole turn, where the circle would be without bounds, by
  /// what differs from it.
  static Eigen::VectorXd arcs(const Eigen::VectorXd& turns);

 private:
  using Complex = std::complex<double>;

  struct Part {
    std::vector<int> anchor;  ///< never empty
    Complex from, to;         ///< of the anchor
    double turn, arc;
    SlopeChange<double> turn_change{}, arc_change{};
    SlopeChange<Complex> path_change{};
  };

  static Complex path(const Part& part, double u);
  static Complex path_slope(const Part& part, double u);

  const EdgeGraph& graph_;
  std::vector<Part> parts_;
  std::vector<int> isolated_;
  std::vector<Complex> isolated_from_, isolated_way_;
  std::vector<SlopeChange<Complex>> isolated_change_;
};

}  // namespace planar
