// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/sub_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "base/index.h"

namespace planar {

namespace {

constexpr double furthest = 1e6;  // in boxes: what lies further out shares the last one

}  // namespace

SubCells::SubCells(const InSteps& places, const Eigen::VectorXd& measure_of, int parts) {
  std::map<std::array<int, 3>, int> number;
  cell.reserve(at(places.rows()));
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    std::array<int, 3> box{};
    for (Eigen::Index a = 0; a < 3; ++a) {
      box[at(a)] = static_cast<int>(std::floor(std::clamp(parts * places(i, a), -furthest, furthest)));
    }
    cell.push_back(number.try_emplace(box, static_cast<int>(number.size())).first->second);
  }
  const auto n_cells = static_cast<Eigen::Index>(number.size());
  measure.assign(number.size(), 0.0);
  InSteps mean = InSteps::Zero(n_cells, 3);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    const int c = cell[at(i)];
    measure[at(c)] += measure_of[i];
    mean.row(c) += measure_of[i] * places.row(i);
  }
  middle.assign(number.size(), -1);
  std::vector<double> least(number.size(), std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    const int c = cell[at(i)];
    const double distance = (places.row(i) - mean.row(c) / measure[at(c)]).squaredNorm();
    if (middle[at(c)] >= 0 && !(distance < least[at(c)])) continue;
    least[at(c)] = distance;
    middle[at(c)] = static_cast<int>(i);
  }
}

}  // namespace planar
