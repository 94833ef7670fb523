// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "planar/handle.h"
#include "planar/types.h"

namespace planar {

enum class InbetweenMethod {
  midpoint,  ///< an isometric relation between frames; the keys alone decide, times only sample
  paper,     ///< Algorithm 2 of [AIAP]
  global,    ///< Algorithm 1 of [AIAP]
};

enum class AnchorPath {
  straight,  ///< anchors move on straight lines
  arc,       ///< anchors move on the circular arcs of their part's rigid motion
};

/// What becomes of times outside of the keys'.
enum class Outside {
  refuse,
  extrapolate,  ///< up to as far as the outermost two keys are apart; beyond it is refused
};

struct InbetweenOptions {
  InbetweenMethod method = InbetweenMethod::midpoint;

  /// K times of the keys, ascending, their differences finite; empty: 0, 1, ..., K-1.
  Eigen::VectorXd key_times{};

  /// n×2 rest shape, or empty. It gives the lengths and the size that weights and tolerance refer to, in
  /// place of the keys' means, so that what is between two keys depends on no other key.
  Points rest{};

  /// (K-1)×parts extra whole turns between two keys, counter-clockwise, at most 100; a single column is for
  /// all parts; empty: none. Parts are numbered in order of their first vertices, isolated vertices left out.
  Eigen::MatrixXi turns{};

  /// Vertices whose mean, part by part, moves on the path: one set for all transitions, or K-1 sets. Parts
  /// without any are held at their centroid.
  std::vector<Eigen::VectorXi> anchors{};
  AnchorPath anchor_path = AnchorPath::straight;

  /// Layers that hang together: rows of a vertex of the carrying part and one of the carried part, for which
  /// the offset from the first to the second goes straight from what it is in one key to what it is in the
  /// next; the carried part has no anchor then. No part is carried twice, none carries itself in the end.
  /// None at all, one set for all transitions, or K-1 sets.
  std::vector<Edges> joints{};

  /// Points of a mesh that are held on their ways from key to key (midpoint only; the others refuse them):
  /// straight ones, so that what stands in both keys stands, or those of Inbetweens::at. Of a part with
  /// several of them they decide place and turn.
  Handles pins{};

  /// k labels, or empty: all different. Handles with equal labels are one pin (a patch), which is turned as
  /// it goes: its middle goes straight.
  Eigen::VectorXi pin_groups{};

  /// (K-1)×k: which pins are held between which two keys, patches as a whole; empty: all. A pin that is held
  /// on one side of a key only may change its velocity there.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> pinned{};

  /// Velocities are continuous at the keys, too (midpoint only; the others refuse it). What is between two
  /// keys then depends on the two next to them as well, and on the times.
  bool smooth = false;

  /// [AIAP 11]: a solution has converged when no vertex moves by more than this share of the box diagonal; of
  /// the square that holds the shapes however they are turned, so that turned keys give turned frames.
  double tolerance = 5e-4;
  int max_iterations = 100;

  /// About so many vertices, 12 at least, of a coarse mesh to solve on in place of a larger one (midpoint and
  /// triangles only; the others refuse it); empty: solve on the mesh itself.
  std::optional<int> cage{};

  int threads = 0;  ///< to use, at most 64; 0: one per core, at most 8. The result does not depend on it

  /// Called with the share of the work done, in the caller's thread; false stops by `Cancelled`.
  std::function<bool(double)> progress{};
};

/// What became of the way from one key to the next.
struct TransitionReport {
  int iterations = 0;     ///< of the solution
  bool converged = true;  ///< within InbetweenOptions::max_iterations; tracked frames (departure 6) likewise

  /// Parts in which triangles lie the other way round in one key than in the other: they flip on the way,
  /// which nothing can keep them from. (Numbered as for InbetweenOptions::turns.)
  std::vector<int> unrepaired{};
};

/// Shapes between key shapes, as isometric as possible [AIAP]: solved once, then sampled at any
/// time.
///
/// \code
///   Inbetweens motion({rest, raised, lowered}, triangles);
///   for (double t = 0.0; t <= 2.0; t += 1.0 / 24.0) show(motion.at(t));
/// \endcode
///
/// Departures from the paper:
///
/// 1. Frames are related by the midpoint rule e[k+1] - e[k] = i τ (e[k] + e[k+1]), which turns an edge
/// without changing its length however large the step; the paper's forward difference lengthens it. It is
/// symmetric in time, so the reverse sampling is not needed.
///
/// 2. Turns are unwrapped on triangles, smallest difference first, and the mean turn of a part is taken out
/// and put back exactly, so that only bending is approximated.
///
/// 3. The weights 1/|e| of [AIAP 10] are frozen, at the keys' mean or the rest shape: one factor for all
/// frames and iterations.
///
/// 4. The unknowns live on a grid between two keys that depends on these two alone. Sampling between its
/// frames interpolates each edge's length and angle, and assembles by [AIAP 10].
///
/// 5. Edges know lengths only. Two Newton steps take the frames of a mesh's grid towards the shapes in which
/// triangles are least distorted from what they are in the two keys, blended.
///
/// 6. Where triangles of a mesh would be flipped or three times as long or short as they should be on the
/// way, though they lie the same way round in both keys, the transition is tracked: its frames minimise w |x
/// - y|² to the frame y as it was, plus the symmetric Dirichlet energy with respect to the two keys'
/// triangles, blended, each starting from its neighbour.
///
/// 7. If smooth, lengths and angles of edges, turns of parts and places of anchors meet a key between others
/// with the same slope from both sides: each its harmonic mean, so that what rests or turns back at a key
/// does so without overshoot. Cubics that are 0 at the keys are added for it. A part whose anchor is another
/// one behind the key turns and bends smoothly, but its anchors keep to their own paths.
///
/// 8. Translation, which the paper leaves out: an anchor of each part moves on a path, or another part
/// carries it. Isolated vertices move straight.
///
/// 9. Pins: a frame in which they are not where they should be becomes the rest shape of Poser's method hold,
/// which settles with the pins at their places. A part that is carried comes along by the way that its joint
/// goes then. Pins whose ways would have triangles turned over fall short of them.
class Inbetweens {
 public:
  /// \param keys K ≥ 2 shapes, n×2 each
  ///
  /// \param triangles m×3
  ///
  /// \throw std::invalid_argument too few, mismatched, non-finite or out-of-range input; a method other than
  /// midpoint
  ///
  /// \throw SolveError the frames cannot be assembled
  ///
  /// \throw Cancelled options.progress returned false
  Inbetweens(const std::vector<Points>& keys, const Triangles& triangles,
             const InbetweenOptions& options = {});

  /// The same for edges (m×2) without faces: contours, open lines or any edge soup.
  Inbetweens(const std::vector<Points>& keys, const Edges& edges, const InbetweenOptions& options = {});

  Inbetweens(Inbetweens&&) noexcept;
  Inbetweens& operator=(Inbetweens&&) noexcept;
  ~Inbetweens();

  /// The shape (n×2) at a time from the first key's to the last one's; at a key's time that key, to the bit.
  /// Outside of them the outermost transitions go on with the velocities that they have there.
  /// \throw std::invalid_argument outside of the keys' times, see Outside
  Points at(double time, Outside outside = Outside::refuse) const;

  /// The shapes at several times in any order; each is what at(time) gives. `progress` is called with the
  /// share of them done, in the caller's thread; false stops by `Cancelled`.
  ///
  /// \param pin_paths where the handles of InbetweenOptions::pins are to be, k×2 for each time, or empty. One
  /// that is not a number goes its own way. At a key's time there is the key, to which the others should
  /// lead.
  std::vector<Points> at(const Eigen::VectorXd& times, Outside outside = Outside::refuse,
                         const std::function<bool(double)>& progress = {},
                         const std::vector<Points>& pin_paths = {}) const;

  /// K-1 reports on the solution.
  const std::vector<TransitionReport>& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Frames (n×2) at `times` between `keys`. Method midpoint is Inbetweens. The paper's two methods sample
/// uniformly between two keys, so they take two keys and uniform times from the first to the last.
///
/// \param pin_paths as Inbetweens::at
///
/// \throw std::invalid_argument as Inbetweens; `times` that the method cannot give
///
/// \throw SolveError the frames cannot be assembled, or the iteration diverges
///
/// \throw Cancelled options.progress returned false
std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Triangles& triangles, const InbetweenOptions& options = {},
                              const std::vector<Points>& pin_paths = {});

/// The same for edges without faces.
std::vector<Points> inbetween(const std::vector<Points>& keys, const Eigen::VectorXd& times,
                              const Edges& edges, const InbetweenOptions& options = {},
                              const std::vector<Points>& pin_paths = {});

}  // namespace planar
