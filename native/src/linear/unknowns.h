// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "linear/sparse_solver.h"

namespace planar {

/// Some vertices of a graph as the unknowns of a system, in an order in which its factor stays sparse.
struct Unknowns {
  /// \param edges between which vertices the system has entries
  /// \param free a flag a vertex: it is an unknown
  template <class Number>
  Unknowns(CholeskySolver<Number>& solver, const std::vector<std::array<int, 2>>& edges,
           const std::vector<char>& free);

  /// The system's matrix, of values 0.
  template <class Number>
  SelfAdjointMatrix<Number> zero() const {
    SelfAdjointMatrix<Number> matrix(pattern);
    matrix.value.assign(matrix.row.size(), Number(0));
    return matrix;
  }

  int size;
  std::vector<int> slot;    ///< of a vertex among the unknowns, or -1
  SparsityPattern pattern;  ///< an entry a pair of unknowns
};

}  // namespace planar
