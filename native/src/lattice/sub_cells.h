// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace planar {

/// Places of things, triangles or vertices, in steps of a lattice.
using InSteps = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Things sorted into boxes of an equal part of a lattice's cell. Only boxes with something in them exist.
struct SubCells {
  std::vector<int> cell;    ///< of each thing, numbered from 0
  std::vector<int> middle;  ///< of a box: the thing in it that lies nearest to the middle of all that does
  std::vector<double> measure;  ///< of a box: of all that lies in it

  /// \param parts of a cell along each axis
  /// \param measure_of a thing, above 0
  SubCells(const InSteps& places, const Eigen::VectorXd& measure_of, int parts);
};

}  // namespace planar
