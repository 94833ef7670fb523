// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/point_matrix.h"

#include <algorithm>
#include <utility>

#include "base/index.h"

namespace planar {

PointMatrix::PointMatrix(int n_points, const std::vector<std::array<int, 2>>& coupled, int unknowns)
    : unknowns_(unknowns), place_(at(n_points)), solver_(SparseSolver::create(default_backend())) {
  point_ = solver_->fill_reducing_order(graph_pattern(n_points, coupled));
  for (int k = 0; k < n_points; ++k) place_[at(point_[at(k)])] = k;
  std::vector<std::array<int, 2>> placed;
  placed.reserve(coupled.size());
  for (const auto& [a, b] : coupled) placed.push_back({place(a), place(b)});
  pattern_ = graph_pattern(n_points, placed);
  matrix_.size = unknowns * n_points;
  matrix_.column_start.push_back(0);
  for (int k = 0; k < n_points; ++k) {
    for (int axis = 0; axis < unknowns; ++axis) {
      for (int e = pattern_.column_start[at(k)]; e < pattern_.column_start[at(k) + 1]; ++e) {
        for (int other = 0; other < unknowns; ++other) {
          const int row = unknowns * pattern_.row[at(e)] + other;
          if (row >= unknowns * k + axis) matrix_.row.push_back(row);
        }
      }
      matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
    }
  }
  matrix_.value.assign(matrix_.row.size(), 0.0);
  solver_->analyze(matrix_);
}

PointMatrix::Block PointMatrix::block(std::vector<int> place) const {
  Block result{std::move(place), {}};
  result.entry.reserve(result.place.size() * (result.place.size() + 1) / 2);
  for (std::size_t i = 0; i < result.place.size(); ++i) {
    const int earlier = result.place[i];
    for (std::size_t j = i; j < result.place.size(); ++j) {
      result.entry.push_back(pattern_.find(result.place[j], earlier) - pattern_.column_start[at(earlier)]);
    }
  }
  return result;
}

void PointMatrix::set_zero() { std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0); }

void PointMatrix::add(const Block& block, const double* value) {
  const int* entry = block.entry.data();
  for (std::size_t i = 0; i < block.place.size(); ++i) {
    double* entries = matrix_.value.data() + column(block.place[i], 0);
    for (std::size_t j = i; j < block.place.size(); ++j) entries[*entry++] += *value++;
  }
}

void PointMatrix::add_square(const std::vector<int>& points, const double* row, double weight) {
  std::vector<std::pair<int, double>> entries;
  entries.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) entries.emplace_back(place(points[i]), row[i]);
  std::sort(entries.begin(), entries.end());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto [earlier, value] = entries[i];
    for (std::size_t j = i; j < entries.size(); ++j) {
      const int number = pattern_.find(entries[j].first, earlier) - pattern_.column_start[at(earlier)];
      for (int axis = 0; axis < unknowns_; ++axis) {
        // In each of its columns a point has the same number for the row of that axis of another.
        matrix_.value[column(earlier, axis) + at(unknowns_ * number)] += weight * value * entries[j].second;
      }
    }
  }
}

void PointMatrix::add_form(const Block& block, const std::array<double, 2>* gradient,
                           const std::array<std::array<double, 4>, 4>& form) {
  const int* entry = block.entry.data();
  for (std::size_t i = 0; i < block.place.size(); ++i) {
    double* x = matrix_.value.data() + column(block.place[i], 0);
    // Column of y: its first entry is its diagonal one, so that later points begin one earlier.
    double* y = matrix_.value.data() + column(block.place[i], 1) - 1;
    const double gx = gradient[i][0], gy = gradient[i][1];
    std::array<double, 4> of_x{}, of_y{};  // H times this point's columns
    for (std::size_t k = 0; k < 4; ++k) {
      of_x[k] = form[k][0] * gx + form[k][1] * gy;
      of_y[k] = form[k][2] * gx + form[k][3] * gy;
    }
    x[0] += gx * of_x[0] + gy * of_x[1];
    x[1] += gx * of_x[2] + gy * of_x[3];
    y[1] += gx * of_y[2] + gy * of_y[3];
    ++entry;
    for (std::size_t j = i + 1; j < block.place.size(); ++j, ++entry) {
      const double hx = gradient[j][0], hy = gradient[j][1];
      const int e = 2 * *entry;
      x[e] += hx * of_x[0] + hy * of_x[1];
      x[e + 1] += hx * of_x[2] + hy * of_x[3];
      y[e] += hx * of_y[0] + hy * of_y[1];
      y[e + 1] += hx * of_y[2] + hy * of_y[3];
    }
  }
}

void PointMatrix::add_to_diagonal(double value) {
  for (int k = 0; k < matrix_.size; ++k) matrix_.value[at(matrix_.column_start[at(k)])] += value;
}

double PointMatrix::scale() const {
  double sum = 0.0;
  for (int k = 0; k < matrix_.size; ++k) sum += matrix_.value[at(matrix_.column_start[at(k)])];
  return sum / std::max(matrix_.size, 1);
}

void PointMatrix::fix(const std::vector<char>& fixed) {
  const auto is_fixed = [&](int unknown) { return fixed[at(point_[at(unknown / unknowns_)])] != 0; };
  for (int k = 0; k < matrix_.size; ++k) {
    for (int e = matrix_.column_start[at(k)]; e < matrix_.column_start[at(k) + 1]; ++e) {
      const int row = matrix_.row[at(e)];
      if (is_fixed(k) || is_fixed(row)) matrix_.value[at(e)] = row == k ? 1.0 : 0.0;
    }
  }
}

void PointMatrix::factorize() { solver_->factorize(matrix_); }

void PointMatrix::solve(RightSides& x) {
  const Eigen::Index n = x.rows();
  if (unknowns_ == 2) {
    unknown_.resize(2 * n);
    for (Eigen::Index k = 0; k < n; ++k) unknown_.segment<2>(2 * k) = x.row(point_[at(k)]).transpose();
    solver_->solve(unknown_, unknown_);
    for (Eigen::Index k = 0; k < n; ++k) x.row(point_[at(k)]) = unknown_.segment<2>(2 * k).transpose();
    return;
  }
  sides_.resize(n, x.cols());
  for (Eigen::Index k = 0; k < n; ++k) sides_.row(k) = x.row(point_[at(k)]);
  solver_->solve(sides_);
  for (Eigen::Index k = 0; k < n; ++k) x.row(point_[at(k)]) = sides_.row(k);
}

}  // namespace planar
