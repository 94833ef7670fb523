// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "planar/arap.h"
#include "planar/handle.h"
#include "planar/poser.h"
#include "planar/types.h"

namespace planar {

enum class FlattenMethod {
  hold,       ///< the flat shape of least distortion; no triangle is turned over
  two_steps,  ///< [ARAP09, section 7]; triangles may be
};

struct FlattenOptions {
  FlattenMethod method = FlattenMethod::hold;

  /// hold: Newton steps at most, 0: until nothing is left to do, at most 400; two_steps: repetitions of the
  /// second step with turns taken from the result before.
  int iterations = 0;

  ArapWeights weights = ArapWeights::cotangent;  ///< of the two steps, from which hold starts as well

  /// Two vertices of an edge. The two steps start from it, and the result has it along the positive x axis.
  /// Without: an edge in the middle of the surface, and the result lies along the x axis.
  std::optional<std::array<int, 2>> fixed{};

  double pin_weight = Poser::default_pin_weight;  ///< μ of a pin or of a vertex of a line, above 0

  /// Called with the share of the work done, in the caller's thread; false stops by `Cancelled`. How many
  /// steps there will be is not known: the share grows ever more slowly, and jumps to 1 at the end.
  std::function<bool(double)> progress{};
};

/// Vertices held on a straight line of the plane while a surface is flattened.
struct HeldLine {
  Eigen::VectorXi vertices;      ///< at least one
  Eigen::RowVector2d point;      ///< of the line
  Eigen::RowVector2d direction;  ///< of the line, not 0
};

/// A piece of surface laid flat: the flat shape of least distortion of its triangles, and live with pins.
///
/// \code
///   Flattener flattener(vertices, triangles);                         // registered, and laid flat
///   flattener.set_pins(Handles::at_vertices(vertex, vertices.rows()));
///   for (const Points& targets : path) show(flattener.move(targets));
///   show(flattener.settle());
/// \endcode
///
/// Surfaces are connected and have one boundary at least, and holes, but no handles: such as can be laid flat
/// without cutting. They lie counter-clockwise as seen from the side that most of their area takes for the
/// outer one; triangles that are wound the other way are flattened as if they were not.
///
/// Method hold minimises the energy of Poser's method hold,
///
///   E(x) = Σ_t A_t (|J|² + |J⁻¹|²) + Σ_i μ |p_i - target_i|² + Σ_l Σ_v μ (n_l · (x_v - point_l))²,
///
/// J from each triangle laid flat by itself to where it is in x, the last two sums of pins and held lines.
/// The scale is that of least distortion: true where the surface can be unrolled. It starts from the two
/// steps, or, where these turn a triangle over, from Tutte's map [Tutte63], with weights that keep the rings
/// of long sleeves from shrinking below what float64 tells. Triangles of it that are too small all the same
/// are repaired on the way [Garanzha21]; what that leaves flipped is refused by SolveError.
///
/// Method two_steps is [ARAP09, section 7]. Departures: d' of its figure 5 lies on the other side of the edge
/// (the printed sign puts both triangles on one side); T' of (6) is divided by its size and not by that
/// squared; weights multiply the squares.
///
/// Without pins the result has its centroid at 0 and lies along the x axis: it is longest in that direction,
/// or where it has none (a disc, a square), an edge in its middle does.
///
/// Triangles that nobody can see (area below 1e-6 of the median one, or altitude below 1e-3 of the median
/// one) stop nothing and are not judged. Flips are judged on float32, as Blender stores. Vertices of no
/// triangle are at 0.
class Flattener {
 public:
  /// \param vertices n×3
  /// \param triangles m×3
  ///
  /// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input; a surface that is
  /// closed, in several parts, not manifold, one-sided, with handles, or without area, with what to do about
  /// it; `fixed` that is no edge
  ///
  /// \throw SolveError no flat shape without flips was found
  ///
  /// \throw Cancelled options.progress returned false
  Flattener(const SpacePoints& vertices, const Triangles& triangles, const FlattenOptions& options = {});
  Flattener(Flattener&&) noexcept;
  Flattener& operator=(Flattener&&) noexcept;
  ~Flattener();

  /// Replaces all pins and lines; positions stay. An edge of the surface is kept straight by its vertices as
  /// a line, say fitted_line().
  ///
  /// \param weights k factors above 0 on pin_weight, or empty: all 1
  /// \throw std::invalid_argument handles that are not in a triangle, mismatched sizes, weights not above 0,
  /// lines without vertices or direction
  void set_pins(Handles pins, std::vector<HeldLine> lines = {}, const Eigen::VectorXd& weights = {});

  /// The straight line nearest to these vertices as they lie now, at least two in different places.
  /// \throw std::invalid_argument
  HeldLine fitted_line(const Eigen::VectorXi& vertices) const;

  /// Two Newton steps towards targets (k×2 of the pins), as Poser::move() with hold.
  /// \return the new positions (n×2), valid until the object changes
  /// \throw std::invalid_argument not k×2 or not finite
  /// \throw SolveError numbers overflow
  const Points& move(const Points& targets);
  /// About as much as a move towards the last targets, in which no vertex goes far: for frames while the
  /// mouse rests.
  const Points& refine();
  /// All that is left to do towards the last targets, at most 200 steps. Without any pins and lines: back to
  /// least distortion.
  const Points& settle();

  /// Back to where it was laid flat first. Pins stay, their targets are where they are then.
  void reset();

  const Points& positions() const;
  /// Of the last call. iterations, substeps: Newton steps, of the two steps: repetitions.
  const Report& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A piece of surface laid flat, n×2: Flattener's first positions.
Points flatten(const SpacePoints& vertices, const Triangles& triangles, const FlattenOptions& options = {});

}  // namespace planar
