// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "base/index.h"
#include "inbetween/pin_holder.h"
#include "inbetween/pin_ways.h"
#include "mesh/edge_graph.h"
#include "planar/inbetween.h"

namespace planar {

/// Points on the parts that carry others and on those that are carried, k each.
struct JointPoints {
  Handles carrying, carried;
};

/// The pins of in-betweens, checked, on the mesh that is solved.
struct FramePins {
  /// \throw std::invalid_argument options.pins, pin_groups, pinned or joints do not fit to the graph or each
  /// other
  FramePins(const EdgeGraph& graph, const std::vector<Points>& keys, const InbetweenOptions& options);

  Handles handles;
  std::vector<PinRows> pins;
  std::vector<std::vector<char>> held;  ///< a flag a pin, for each transition
  std::vector<int> part;                ///< of each handle, as in the graph; -1: of an isolated vertex
  Triangles triangles;                  ///< of the parts with pins
  std::vector<Points> places;           ///< K of k×2: in the keys
  std::vector<JointPoints> joints;      ///< of each transition

  /// From where handles are on a frame x between keys k and k+1 to where what it carries has them, at u;
  /// empty: it carries nothing.
  std::function<Points(const Points& x, std::size_t k, double u)> beyond;
};

/// The triangles of parts that one of some handles is on, -1 standing for none.
Triangles triangles_of(const Triangles& triangles, const std::vector<int>& vertex_part,
                       const std::vector<int>& handle_part);

/// Holds the pins of frames between two keys. Parts that carry others are held first; a part that is carried
/// comes along, and is held at its joint where it has pins of its own.
class PinnedTransition {
 public:
  /// \param pins, graph to outlive this
  /// \param k of the transition
  /// \param edge_turns radians by which edges turn on the way, whole turns included
  PinnedTransition(const EdgeGraph& graph, const FramePins& pins, std::size_t k,
                   const Eigen::VectorXd& edge_turns);

  /// k×2: where the handles go by themselves, at u.
  Points places(double u) const { return ways_.at(u); }

  /// The frame at u with its handles, or those of what it carries, at `places` (k×2). Those that are not held
  /// in this transition have none.
  /// \throw SolveError as PinHolder
  Points held(const Points& frame, double u, const Points& places, PinHolder& holder) const;

  /// Has what is held before and after the key between two transitions pass it with one velocity.
  static void join(PinnedTransition& before, PinnedTransition& after, KeyGaps gaps);

 private:
  /// Parts that are carried by as many others, one on top of the other.
  struct Layer {
    HandleSet handles;             ///< first pins, then joints
    std::vector<int> rows;         ///< of the pins
    std::vector<int> joints;       ///< rows of those that carry the parts of this layer
    std::vector<int> held_joints;  ///< of these the ones of parts with pins
  };

  std::size_t part_of(const Handles& points, Eigen::Index row) const {
    return at(graph_.part[at(points.vertices(row, 0))]);
  }
  void carry_along(const Layer& layer, const Points& frame, Points& x) const;
  void hold(const Layer& layer, double u, const Points& places, PinHolder& holder, Points& x) const;

  const EdgeGraph& graph_;
  const FramePins& pins_;
  std::size_t k_;
  const std::vector<char>& held_;
  PinWays ways_;
  const JointPoints& joints_;
  std::vector<Layer> layers_;  ///< none if no pin is held
};

}  // namespace planar
