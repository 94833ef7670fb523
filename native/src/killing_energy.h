// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "mesh.h"
#include "sparse_solver.h"

namespace planar {

/// The graph over `kept` vertices (numbered by their place in it) that the Killing matrix has blocks on.
SymmetricMatrix vertex_graph(const Mesh& mesh, const std::vector<int>& kept);

/// The matrix K = PᵀP of the Killing energy ∫|J + Jᵀ|² (Solomon et al. 2011, (2) and (5)-(7)) over some
/// vertices of a mesh; the others count as fixed. Vertex kept[i] has unknowns 2i (x) and 2i+1 (y). Per
/// triangle, with Gx, Gy the gradients of the hat functions, P = √A·[2Gx 0; √2·Gy √2·Gx; 0 2Gy]; printed
/// without the integral's area and with the full G in every entry, it would give rotations energy. K does not
/// depend on the unit of length. Places of triangle blocks are looked up once; assembling only computes and
/// adds.
///
/// The area that P divides by is at least 1e-5 of the longest edge squared, and a triangle below that gets
/// springs along its edges (of the stiffness of that least area), because a flat one does not resist
/// stretching: so every triangle's energy is zero for rigid motions only, however flat it is. Flat triangles
/// next to each other may still be hinged at an edge without length; a hundredth of the springs' stiffness
/// holds their corners where they are, or rather where the rigid field that the solver takes off first puts
/// them. Orientation does not matter.
class KillingMatrix {
 public:
  KillingMatrix(const Mesh& mesh, const std::vector<int>& kept);

  /// Fills in K for positions x, with stiffness[t] times the energy of triangle t. Parts that are not
  /// `active` get unit rows.
  void assemble(const Points& x, const Eigen::VectorXd& stiffness, const std::vector<char>& active);

  /// Adds value·I to the block of vertices a and b, which must be kept and share a triangle.
  void add(int a, int b, double value);

  const SymmetricMatrix& matrix() const { return matrix_; }

  /// Place of a vertex in `kept`, or -1.
  int place(int vertex) const { return place_[static_cast<std::size_t>(vertex)]; }

 private:
  /// A triangle with its corners in order of their unknowns. Rows and columns of fixed corners go to spare
  /// room behind the values.
  struct Element {
    std::array<int, 3> vertex;
    std::array<int, 3> diagonal;    ///< of the column of x of corner c: its first entry
    std::array<int, 3> diagonal_y;  ///< of the column of y
    std::array<int, 3> below;    ///< entry (x of the later corner, x of the earlier) of the sides 01, 02, 12
    std::array<int, 3> below_y;  ///< the same in the column of y of the earlier corner
    int triangle;                ///< row, or -1 for a brace
    int part;
  };

  int find_block(int later, int earlier) const;
  void add_element(const Element& element, const Points& x, double stiffness);
  void add_springs(const Element& element, const std::array<Eigen::Vector2d, 3>& side, double stiffness);

  SymmetricMatrix matrix_;
  std::vector<int> place_;
  std::vector<int> kept_part_;
  std::vector<Element> elements_;
};

}  // namespace planar
