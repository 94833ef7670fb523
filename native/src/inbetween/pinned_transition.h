// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "inbetween/pin_holder.h"
#include "inbetween/pin_ways.h"
#include "mesh/edge_graph.h"
#include "planar/inbetween.h"

namespace planar {

/// The pins of in-betweens, checked.
struct FramePins {
  /// \throw std::invalid_argument options.pins, pin_groups or pinned do not fit to the graph or each other
  FramePins(const EdgeGraph& graph, const std::vector<Points>& keys, const InbetweenOptions& options);

  Handles handles;
  std::vector<PinRows> pins;
  std::vector<std::vector<char>> held;  ///< a flag a pin, for each transition
  std::vector<int> part;                ///< of each handle, as in the graph; -1: of an isolated vertex
  Triangles triangles;                  ///< of the parts with pins
};

/// Holds the pins of frames between two keys. Parts that carry others are held first; a part that is carried
/// comes along, and is held at its joint where it has pins of its own.
class PinnedTransition {
 public:
  /// \param pins, graph to outlive this
  /// \param k of the transition
  /// \param joints of it, checked
  /// \param edge_turns radians by which edges turn on the way, whole turns included
  PinnedTransition(const EdgeGraph& graph, const FramePins& pins, std::size_t k, const Points& from,
                   const Points& to, const Edges& joints, const Eigen::VectorXd& edge_turns);

  /// k×2: where the handles go by themselves, at u.
  Points places(double u) const { return ways_.at(u); }

  /// The frame with its handles at `places` (k×2). Those that are not held in this transition have none.
  /// \throw SolveError as PinHolder
  Points held(const Points& frame, const Points& places, PinHolder& holder) const;

  /// Has what is held before and after the key between two transitions pass it with one velocity.
  static void join(PinnedTransition& before, PinnedTransition& after, KeyGaps gaps);

 private:
  /// Parts that are carried by as many others, one on top of the other.
  struct Layer {
    HandleSet handles;                 ///< first pins, then joints
    std::vector<int> rows;             ///< of the pins
    std::vector<int> joint_vertex;     ///< carried vertices of the parts with pins
    std::vector<Edges::Index> joints;  ///< rows of those that carry the parts of this layer
  };

  void carry_along(const Layer& layer, const Points& frame, Points& x) const;

  const EdgeGraph& graph_;
  const std::vector<char>& held_;
  PinWays ways_;
  Edges joints_;
  std::vector<Layer> layers_;  ///< none if no pin is held
};

}  // namespace planar
