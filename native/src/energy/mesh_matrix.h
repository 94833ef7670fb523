// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "linear/sparse_solver.h"
#include "mesh/mesh.h"

namespace planar {

/// The graph over `kept` vertices (numbered by their index in it, their slot) that a MeshMatrix has blocks
/// on: the mesh's edges, the missing sides of its braces, and `links` beside them, pairs of vertices.
SparsityPattern vertex_graph(const Mesh& mesh, const std::vector<int>& kept,
                             const std::vector<std::array<int, 2>>& links = {});

/// A symmetric matrix of 2×2 blocks over some vertices of a mesh, to be assembled triangle by triangle; the
/// others count as fixed. Vertex kept[i] has unknowns 2i (x) and 2i+1 (y). The places of a triangle's blocks
/// are looked up once; assembling only computes and adds.
class MeshMatrix {
 public:
  /// A triangle with its corners in order of their unknowns, and where its blocks are among the values. Rows
  /// and columns of fixed corners go to spare room behind them.
  struct Element {
    std::array<int, 3> vertex;
    std::array<int, 3> diagonal;    ///< of the column of x of corner c: its first entry
    std::array<int, 3> diagonal_y;  ///< of the column of y
    std::array<int, 3> below;    ///< entry (x of the later corner, x of the earlier) of the sides 01, 02, 12
    std::array<int, 3> below_y;  ///< the same in the column of y of the earlier corner
    int triangle;                ///< row, or -1 for a brace
    int part;
  };

  MeshMatrix(const Mesh& mesh, const std::vector<int>& kept,
             const std::vector<std::array<int, 2>>& links = {});

  const std::vector<Element>& elements() const { return elements_; }
  double* values() { return matrix_.value.data(); }

  void set_zero();
  /// Gives parts that are not `active` unit rows, and isolated vertices too.
  /// \pre they are zero
  void set_unit_rows(const std::vector<char>& active);

  /// Adds value·I to the block of vertices a and b, which must be kept and share a triangle or a
  /// link.
  void add(int a, int b, double value);

  /// Adds a symmetric block to that of vertex v, which must be kept, with itself.
  void add(int v, const Eigen::Matrix2d& block);

  const SymmetricMatrix& matrix() const { return matrix_; }
  /// The largest entry of the diagonal: of a semidefinite matrix no other is larger.
  double largest() const;

  /// Slot of a vertex: its index in `kept`, or -1.
  int slot(int vertex) const { return slot_[static_cast<std::size_t>(vertex)]; }

 private:
  int find_block(int later, int earlier) const;

  SymmetricMatrix matrix_;
  std::vector<int> slot_;
  std::vector<int> kept_part_;
  std::vector<Element> elements_;
};

}  // namespace planar
