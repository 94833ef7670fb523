// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "planar/handle.h"
#include "planar/types.h"

namespace planar {

/// n×2 or n×3 positions, one row a vertex or a point of a lattice.
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// n×N: row i has the weights with which the points of a lattice move vertex i.
using LatticeWeights = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

/// How the points of one axis share a place between them. With s the place in units of the spacing, from the
/// first point, and n points:
enum class LatticeBasis {
  bernstein,    ///< [LPFFD 1, 2], of degree n - 1 (the printed degree, n, has n + 1 points)
  linear,       ///< Blender's four: weights of the points floor(s) - 1 to floor(s) + 2, those that do not
                ///< exist counted to the last one on their side
  cardinal,     ///< cubic, through the points, tension 0.71; not exact on motions that are affine
  catmull_rom,  ///< cubic, through the points, tension 0.5
  bspline,      ///< cubic, smoothest; Blender's default
};

/// A regular lattice of `count` points an axis, 1 to 64, in the space of what it deforms. Point (u, v, w) has
/// the number u + count₀ (v + count₁ w).
struct LatticeGrid {
  std::vector<int> count;           ///< of 2 or 3 axes
  std::vector<LatticeBasis> basis;  ///< one an axis
  Eigen::VectorXd origin;           ///< first point
  Eigen::VectorXd spacing;          ///< between neighbours, above 0; of an axis with one point: unused
};

/// The weights of a lattice's points at n places (n×2 or n×3, one column an axis of the grid), as Blender's
/// Lattice modifier has them (lattice_deform.cc): each row sums to 1. Outside of the grid the displacement is
/// that of its border; bernstein, which Blender does not have, is continued likewise. What the modifier's
/// strength and vertex groups do is a factor on a row, and the caller's to apply.
///
/// \throw std::invalid_argument mismatched axes, counts outside of 1 to 64, spacing not above 0, or not
/// finite, naming the row
LatticeWeights lattice_weights(const Coordinates& places, const LatticeGrid& grid);

/// What a LatticeSolver minimises.
enum class LatticeMethodKind {
  hold,   ///< triangles in 2D: least distortion of the rest shape, no triangle turned over
  paper,  ///< [LPFFD 9] for triangles and edges, 2D and 3D
};

enum class EdgeWeights {
  area,     ///< stretching counts by area (of edges alone, by length): no part counts more for being finer
  uniform,  ///< 1 an edge, as printed
};

struct LatticeOptions {
  std::optional<LatticeMethodKind> method{};     ///< by default hold for triangles in 2D, else paper
  bool rigid_following = true;                   ///< paper: see LatticeSolver
  EdgeWeights edge_weights = EdgeWeights::area;  ///< paper

  // Weights of the terms, not below 0, shape and mesh above 0. Empty: the method's own.
  double weight_shape = 1.0;               ///< λ_ml; hold: factor on the energy of the triangles
  std::optional<double> weight_mesh{};     ///< λ_mp, of handles on the mesh; hold 1e3, paper 1e2
  std::optional<double> weight_lattice{};  ///< λ_gp, of handles that are points of the lattice; the same
  std::optional<double> weight_rest{};  ///< λ_gr, of points to be at rest, 1e-2; hold: of smoothness, 1e-3
};

/// Handles and locked points of a lattice.
struct LatticeHandles {
  Handles mesh{};                    ///< k points of the mesh
  Eigen::VectorXd weights{};         ///< k factors above 0 on weight_mesh, or empty: all 1
  Eigen::VectorXi lattice_points{};  ///< numbers of points that are dragged
  Eigen::VectorXi locked{};          ///< numbers of points that stay where they are, to the bit
};

/// What the last solve(), refine() or settle() did.
struct LatticeReport {
  int iterations = 0;
  double furthest_handle = 0.0;       ///< largest distance of a handle from its target
  Eigen::VectorXd handle_distance{};  ///< of each handle on the mesh

  /// Handles on the mesh further from their targets than 1e-3 of the diagonal of the rest's box when all is
  /// done. Where neighbouring limbs share cells of the lattice they cannot be reached; a finer one helps.
  std::vector<int> unreached{};
  int flipped = 0;  ///< triangles inverted relative to the rest shape, judged as in `distortion`; 3D: 0

  /// Nothing is left to do: the last full step moved nothing by more than 1e-6 of that diagonal. Never after
  /// a solve() that looked at samples only.
  bool converged = true;
};

/// Moves the points P of a lattice such that handles on the mesh it deforms, and points of its own, go to
/// their targets, while the mesh keeps its shape: registered with the rest shape, compiled with the handles,
/// moved with their targets.
///
/// \code
///   LatticeSolver solver(rest, triangles, lattice_weights(rest, grid), lattice_rest);
///   solver.set_handles({Handles::at_vertices(vertex, rest.rows())});
///   for (const Points& targets : path) write(solver.solve(targets));
/// \endcode
///
/// The mesh is at rest + W (P - P⁰), not at W P, so that it is at rest when its lattice is, whatever the
/// basis. Several meshes in one lattice are one mesh of several parts. Points that no vertex depends on are
/// no failure. The matrices' patterns are analysed once; changing handles costs no new analysis.
///
/// Method hold minimises, in the points of the lattice,
///
///   E = Σ_t A_t (|J|² + |J⁻¹|²) + Σ_h μ_h |x_h - c_h|² + Σ_p μ_p |P_p - c_p|² + λ Σ |second differences of P
///   - P⁰|²,
///
/// the symmetric Dirichlet energy [Smith15] of the triangles, springs for the handles, and differences along
/// each axis and, times √2, mixed: they are 0 for affine motions, hence they need to know of no rotation, and
/// keep points that no mesh touches. It descends by projected Newton steps, at most 0.8 of the way to where a
/// triangle collapses, with Armijo's rule. No triangle that lies as at rest is turned over, not even by
/// rounding to float32. In detail:
///
/// 1. A descent to new targets begins at the lowest of: the present state, that state or the rest moved
/// rigidly as the handles would have it, and the rest. Else half a turn gets stuck, and a single handle turns
/// the model. If the present state has triangles turned over, it is not among them.
///
/// 2. The Hessian is summed over sub-cells, 4×4 a cell, each at the rows of one of its triangles; triangles
/// near collapse are taken each at its own. The gradient is exact.
///
/// 3. While dragging, solve() does two steps with one triangle for each of 6×6 parts of a cell, where that is
/// worth it; flips are checked on all triangles, and where one blocks the way, it and others that are badly
/// distorted join the sample. refine() and settle() are exact.
///
/// Triangles that nobody can see at rest (see `distortion`) are carried along and count for nothing.
///
/// Method paper is [LPFFD 9] with the terms (3), (6), (7), (8): rotations of one-rings and one solve in the
/// points of the lattice take turns. The sum over j ∈ L(i) counts each edge twice, as printed. Departures:
///
/// 1. rigid_following: P⁰_i of (8) is R P⁰_i + t with (R, t) the rigid motion of the rest nearest to the
/// model, and a descent to new targets begins as with hold. Printed, (8) is not invariant to rotation
/// [LPFFD, figure 11]; false leaves it so.
///
/// 2. EdgeWeights::area; uniform is printed.
///
/// 3. (5) has an M×M matrix L where M×N terms are meant; (3), which its T refers to, is what is minimised.
///
/// 4. While dragging, solve() looks at one ring for each of 4×4 parts of a cell in 2D, 2×2×2 in 3D, where
/// that is worth it. refine() and settle() look at all.
///
/// 5. Anderson's acceleration of the alternation [Peng18], which has the same fixed points.
///
/// paper turns triangles over on many large poses; report().flipped tells.
class LatticeSolver {
 public:
  using Elements = std::variant<Triangles, Edges>;

  /// \param rest n×2 or n×3
  /// \param elements what keeps its shape
  /// \param weights n×N, finite
  /// \param lattice_rest N×2 or N×3 as `rest`: P⁰, a regular grid in the rest's space, u fastest
  ///
  /// \throw std::invalid_argument empty, mismatched, non-finite or out-of-range input; hold without triangles
  /// in 2D; lattice_rest that is no grid
  ///
  /// \throw SolveError so many points of the lattice depend on each other that their matrix has no room
  LatticeSolver(const Coordinates& rest, const Elements& elements, const LatticeWeights& weights,
                const Coordinates& lattice_rest, const LatticeOptions& options = {});
  LatticeSolver(LatticeSolver&&) noexcept;
  LatticeSolver& operator=(LatticeSolver&&) noexcept;
  ~LatticeSolver();

  /// Replaces all handles and locked points; the shape stays, targets are forgotten.
  ///
  /// \throw std::invalid_argument out of range, mismatched, or a point both dragged and locked
  ///
  /// \throw SolveError the system could not be factored
  void set_handles(const LatticeHandles& handles);

  /// Some steps towards targets: k×D of the handles on the mesh, and of the lattice's points in the order of
  /// set_handles(). For each event of a drag.
  ///
  /// \return the points of the lattice (N×D), valid until the object changes
  ///
  /// \throw std::invalid_argument mismatched or not finite
  ///
  /// \throw SolveError numbers overflow, or no state to begin at has all triangles upright
  const Coordinates& solve(const Coordinates& mesh_targets, const Coordinates& lattice_targets = {});

  /// A few exact steps towards the last targets; without any: nothing.
  /// \throw SolveError
  const Coordinates& refine();
  /// Exact steps until report().converged, at most 200 with hold and 1000 with paper; without targets:
  /// nothing. \throw SolveError
  const Coordinates& settle();

  /// Back to P⁰. Handles stay, targets are forgotten.
  void reset();
  /// Continues from these points (N×D). Handles stay, targets are forgotten.
  /// \throw std::invalid_argument mismatched or not finite
  void reset(const Coordinates& points);

  /// N×D: P
  const Coordinates& points() const;
  /// n×D: rest + W (P - P⁰)
  const Coordinates& positions() const;
  const LatticeReport& report() const;

 private:
  struct State;
  template <int D>
  struct StateIn;
  std::unique_ptr<State> state_;
};

}  // namespace planar
