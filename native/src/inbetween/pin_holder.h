// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/orientation.h"
#include "posing/hold_method.h"

namespace planar {

/// The part of each handle's vertices, of the parts of all vertices.
std::vector<int> parts_of(const Handles& handles, const std::vector<int>& vertex_part);

/// Takes pins of frames to where they should be by PoserMethod::hold, with the frame itself as the rest
/// shape: what is away from the pins is no more distorted than it was. One analysis serves all frames of a
/// mesh; what a frame becomes depends on no other. For one thread at a time.
class PinHolder {
 public:
  /// \param size a shape (n×2) whose diameter is that of the frames: tolerances are shares of it
  /// \param triangles of the parts with pins; other vertices stay
  PinHolder(const Points& size, const Triangles& triangles);
  PinHolder(const PinHolder&) = delete;
  PinHolder& operator=(const PinHolder&) = delete;

  /// Of the frames.
  double size() const { return size_; }

  /// The frame that is next.
  void begin(const Points& frame);
  /// Moves parts with handles to where these are at their places (k×2); other parts stay. x is the frame but
  /// for translations of parts. It is moved rigidly first, then step by step: in one step limbs would fold to
  /// one side in a frame and to the other in the next.
  /// \throw SolveError numbers overflow
  void hold(const HandleSet& handles, const Points& places, Points& x);

 private:
  void move_rigidly(const Handles& handles, const Points& places, Points& x) const;

  Mesh mesh_;
  Orientation orientation_;  ///< of the frame
  HoldMethod method_;
  double size_;
};

}  // namespace planar
