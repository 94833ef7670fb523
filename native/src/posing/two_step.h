// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "linear/sparse_solver.h"
#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "parallel/worker.h"
#include "posing/edge_neighbourhood.h"

namespace planar {

/// The two linear steps of [ARAP09]. The constructor registers a mesh, factor() compiles pins, similar() and
/// adjust_scale() deform by back substitution alone. Points are numbers of the plane.
///
/// similar() minimises Σ w |(v_j - v_i) - T e|² + Σ strength |pin - target|² [ARAP09 4], T the similarity of
/// the edge's neighbourhood, which is linear in v; adjust_scale() minimises [ARAP09 1] for the edges turned
/// by T/|T|: as printed, T/|T|² [ARAP09 6], is no rotation. The weight w of a row is its weight in the
/// energy; multiplied to the rows as printed [ARAP09, section 6] it would be there squared.
///
/// T e is complex-linear in v, so that the system of the first step is one Hermitian matrix of a row a
/// vertex.
///
/// Where pieces of the mesh meet in one vertex alone, a neighbourhood of weight 1e-3 takes the place of the
/// missing triangle: nothing else says how they turn.
class TwoStep {
 public:
  /// \param rest_of with t = -1 for the corners of braces
  ///
  /// \param weight of the mesh's edges, above 0
  ///
  /// \throw SolveError no memory
  TwoStep(const Mesh& mesh, const RestOf& rest_of, const Eigen::VectorXd& weight);

  /// \param active by part: its pins are at two points of the rest at least. The others' results are
  /// arbitrary
  ///
  /// \throw SolveError then again before the next solve
  void factor(const std::vector<Pin>& pins, const std::vector<char>& active);

  /// Step 1 for the pins' targets, Pin::position, the best taken relative to a point among them: n numbers.
  /// \pre factor()
  void similar(const std::vector<Pin>& pins, std::vector<std::complex<double>>& x);

  /// Step 2, from the result of the first one; an edge whose T is 0 keeps its direction at rest.
  void adjust_scale(const std::vector<Pin>& pins, std::vector<std::complex<double>>& x);

  /// An iteration of E(x) = Σ_t Σ_{sides of t} w/(triangles of the side) |(v_j - v_i) - R_t e|² + Σ strength
  /// |pin - target|² with a rotation R_t a triangle: the best rotations for x, then the best x for these
  /// [Liu08]. It has the matrix of step 2. \return E(x), braces included, before the iteration
  double iterate(const std::vector<Pin>& pins, std::vector<std::complex<double>>& x);

 private:
  /// A matrix over the vertices in an order that keeps its factor sparse.
  template <class Solver>
  struct System {
    using Number = typename Solver::Number;

    std::unique_ptr<Solver> solver;
    std::vector<int> slot;  ///< of a vertex
    typename Solver::Matrix matrix;
    std::vector<Number> without_pins;  ///< its values

    System(int n_vertices, const std::vector<std::array<int, 2>>& edges);
    /// Adds to the entry in row a, column b.
    void add(int a, int b, Number value);
    void factor(const std::vector<Pin>& pins, const std::vector<char>& active, const std::vector<int>& part);
  };

  /// A triangle's sides as edges, where they are at rest, and their share of the edge's weight.
  struct Triangle {
    std::array<int, 3> edge;
    std::array<std::complex<double>, 3> rest;
    std::array<double, 3> weight;
  };

  static System<HermitianSolver> make_similarity(const Mesh& mesh,
                                                 const std::vector<EdgeNeighbourhood>& hoods,
                                                 const Eigen::VectorXd& weight);
  static System<SparseSolver> make_scale(const Mesh& mesh, const std::vector<EdgeNeighbourhood>& hoods,
                                         const Eigen::VectorXd& weight);
  void solve_for_edges(const std::vector<Pin>& pins, std::vector<std::complex<double>>& x);

  std::size_t n_edges_;  ///< of the mesh; further neighbourhoods are braces'
  std::vector<int> part_;
  Eigen::VectorXd weight_;  ///< of the neighbourhoods
  std::vector<EdgeNeighbourhood> hoods_;
  std::vector<Triangle> triangles_;
  System<HermitianSolver> similarity_;
  System<SparseSolver> scale_;
  Eigen::VectorXcd unknown_;
  RightSides right_;
  std::vector<std::complex<double>> wanted_;  ///< weight times what each edge should be
  Worker worker_;                             ///< last, so that its thread ends before what it uses
};

}  // namespace planar
