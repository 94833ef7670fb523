// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "inbetween/key_slopes.h"
#include "mesh/edge_graph.h"

namespace planar {

/// A vertex and what it counts.
struct WeightedVertex {
  int vertex;
  double weight;

  bool operator==(const WeightedVertex&) const = default;
};
/// The weighted mean of some vertices of a part.
using Spot = std::vector<WeightedVertex>;

/// What holds the parts in place between two keys, checked.
struct Ties {
  Spot anchor;                              ///< of all parts; parts without any are held at their centroid
  std::vector<std::array<Spot, 2>> joints;  ///< on the carrying part and on the carried one

  Ties() = default;
  Ties(const Eigen::VectorXi& anchor_vertices, const Edges& joint_vertices);
};

/// Sets assembled frames between two keys, which have no place of their own, where they belong: each part's
/// anchor, the mean of some of its vertices, is on its path from one key to the next, or a vertex of it is
/// held next to one of the part that carries it; isolated vertices go straight.
class PartPlacer {
 public:
  /// What is chosen between two keys, one value a part.
  struct Course {
    Eigen::VectorXd turns;      ///< radians by which the part is turned as it goes
    Eigen::VectorXd arc_turns;  ///< radians of the anchor's arc; 0: straight
  };

  /// \param from, to the keys
  PartPlacer(const EdgeGraph& graph, const Points& from, const Points& to, const Ties& ties,
             const Course& course);

  /// The frame at u, 0 at the first key and 1 at the second, or beyond them: a column of `points` turned by
  /// u·turns.
  /// \throw SolveError the numbers overflow
  Points place(const ComplexRows& points, Eigen::Index column, double u) const;

  /// Shifts the parts of x so that anchors and joints are as they are in `placed`.
  void hold_anchors(const Points& placed, Points& x) const;

  /// Has turns and paths meet the key between two transitions with the same velocities. Where the anchors of
  /// a part differ in the two, its path is left as it is.
  static void join(PartPlacer& before, PartPlacer& after, KeyGaps gaps);

  /// The arcs of parts that turn by `turns`; near a whole turn, where the circle would be without bounds, by
  /// what differs from it.
  static Eigen::VectorXd arcs(const Eigen::VectorXd& turns);

 private:
  using Complex = std::complex<double>;

  /// From one key to the next.
  struct Line {
    Complex from, way;
    SlopeChange<Complex> change{};

    Complex at(double u) const { return from + u * way + change.at(u); }
  };

  struct Part {
    Spot anchor;                  ///< never empty
    std::array<Spot, 2> joint{};  ///< on the carrying part and on this one, or empty
    Complex from, to;             ///< of the anchor
    double turn, arc;
    SlopeChange<double> turn_change{}, arc_change{};
    SlopeChange<Complex> path_change{};
    Line offset{};  ///< of the joint
  };

  static Complex path(const Part& part, double u);
  static Complex path_slope(const Part& part, double u);
  std::size_t part_of(int vertex) const {
    return static_cast<std::size_t>(graph_.part[static_cast<std::size_t>(vertex)]);
  }
  bool is_carried(std::size_t part) const { return !parts_[part].joint[0].empty(); }
  std::size_t carrier_of(std::size_t part) const { return part_of(parts_[part].joint[0].front().vertex); }
  std::vector<Complex> shifts(const auto& anchored, const auto& offset_of, const auto& place_of) const;

  const EdgeGraph& graph_;
  std::vector<Part> parts_;
  std::vector<std::size_t> order_;  ///< of parts_, carrying before carried ones
  std::vector<int> isolated_;
  std::vector<Line> isolated_line_;
};

}  // namespace planar
