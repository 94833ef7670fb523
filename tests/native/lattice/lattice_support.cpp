// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/lattice_support.h"

namespace planar::testing {

LatticeGrid grid_round(const Coordinates& points, const std::vector<int>& count, LatticeBasis basis,
                       int margin) {
  const Eigen::VectorXd low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
  LatticeGrid grid{count, std::vector<LatticeBasis>(count.size(), basis), low, high - low};
  for (std::size_t a = 0; a < count.size(); ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    grid.spacing[axis] = (1.0 + 1e-9) * (high[axis] - low[axis]) / std::max(1, count[a] - 1 - 2 * margin);
    grid.origin[axis] = 0.5 * (low[axis] + high[axis]) - 0.5 * (count[a] - 1) * grid.spacing[axis];
  }
  return grid;
}

Coordinates points_of(const LatticeGrid& grid) {
  const auto n_axes = static_cast<Eigen::Index>(grid.count.size());
  const int nw = n_axes == 3 ? grid.count[2] : 1;
  Coordinates points(grid.count[0] * grid.count[1] * nw, n_axes);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const std::array<Eigen::Index, 3> index{i % grid.count[0], i / grid.count[0] % grid.count[1],
                                            i / (grid.count[0] * grid.count[1])};
    for (Eigen::Index a = 0; a < n_axes; ++a) {
      points(i, a) =
          grid.origin[a] + grid.spacing[a] * static_cast<double>(index[static_cast<std::size_t>(a)]);
    }
  }
  return points;
}

Shape bar(int along, int across, double length) {
  Shape shape{Points((along + 1) * (across + 1), 2), Triangles(2 * along * across, 3)};
  for (int j = 0; j <= across; ++j) {
    for (int i = 0; i <= along; ++i) {
      shape.vertices.row(j * (along + 1) + i) << length * i / along, 1.0 * j / across;
    }
  }
  int row = 0;
  for (int j = 0; j < across; ++j) {
    for (int i = 0; i < along; ++i) {
      const int a = j * (along + 1) + i, b = a + along + 1;
      shape.triangles.row(row++) << a, a + 1, b + 1;
      shape.triangles.row(row++) << a, b + 1, b;
    }
  }
  return shape;
}

Coordinates random_coordinates(Eigen::Index n, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Coordinates points(n, columns);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = value(random);
  return points;
}

}  // namespace planar::testing
