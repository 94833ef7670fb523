// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/held_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/index.h"

namespace planar {

namespace {

// |J|² + |J⁻¹|² - 4 from which a triangle is near collapse; on a fine mesh, where more triangles share a
// sub-cell, from a later point on.
constexpr double near_collapse = 12.0;
constexpr double fine_mesh = 5e4;  // triangles

constexpr double regularization = 1e-10;  // of the mean of the diagonal
constexpr double most_regularization = 1e-2;

std::vector<std::array<int, 2>> sides_of(const HeldShape& shape) {
  std::vector<std::array<int, 2>> sides;
  sides.reserve(3 * shape.triangles().size());
  for (const HeldShape::Triangle& triangle : shape.triangles()) {
    const auto& v = triangle.vertex;
    sides.insert(sides.end(), {{v[0], v[1]}, {v[1], v[2]}, {v[2], v[0]}});
  }
  return sides;
}

std::vector<std::array<int, 2>> all_couplings(const LatticeWeights& weights, const HeldShape& shape,
                                              const std::vector<Difference>& differences) {
  std::vector<std::array<int, 2>> result = couplings(weights, sides_of(shape));
  for (const Difference& difference : differences) {
    for (std::size_t i = 0; i < difference.point.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) result.push_back({difference.point[i], difference.point[j]});
    }
  }
  return result;
}

/// The order in which points stand in the matrix.
std::vector<std::size_t> by_place(const std::vector<int>& points, const PointMatrix& matrix) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return matrix.place(points[a]) < matrix.place(points[b]); });
  return order;
}

}  // namespace

HeldSystem::HeldSystem(const LatticeWeights& weights, const HeldShape& shape, SubCells cells,
                       std::vector<Difference> differences, double smooth)
    : shape_(shape),
      cells_(std::move(cells)),
      differences_(std::move(differences)),
      smooth_(smooth),
      near_collapse_(near_collapse *
                     std::max(1.0, static_cast<double>(shape.triangles().size()) / fine_mesh)),
      matrix_(static_cast<int>(weights.cols()), all_couplings(weights, shape, differences_), 2),
      sum_(weights),
      form_(cells_.middle.size()),
      locked_(at(weights.cols()), 0) {
  place_.reserve(cells_.middle.size());
  for (const int triangle : cells_.middle) place_.push_back(place_of(shape.triangles()[at(triangle)]));
}

HeldSystem::Place HeldSystem::place_of(const HeldShape::Triangle& triangle) {
  sum_.clear(2);
  for (int c = 0; c < 3; ++c) sum_.add(triangle.vertex[at(c)], triangle.gradient(c));
  Place result;
  std::vector<int> place;
  for (const std::size_t k : by_place(sum_.points(), matrix_)) {
    const int i = static_cast<int>(k);
    place.push_back(matrix_.place(sum_.points()[k]));
    result.gradient.push_back({sum_.value(i, 0), sum_.value(i, 1)});
  }
  result.block = matrix_.block(std::move(place));
  return result;
}

void HeldSystem::compile(const LatticeSprings<2>& springs) {
  matrix_.set_zero();
  for (const Difference& difference : differences_) {
    matrix_.add_square(difference.point, difference.coefficient.data(), 2.0 * smooth_);
  }
  const LatticeWeights& rows = springs.rows;
  for (Eigen::Index h = 0; h < rows.rows(); ++h) {
    const int from = rows.outerIndexPtr()[h], to = rows.outerIndexPtr()[h + 1];
    const std::vector<int> points(rows.innerIndexPtr() + from, rows.innerIndexPtr() + to);
    matrix_.add_square(points, rows.valuePtr() + from, 2.0 * springs.weight[h]);
  }
  const double one = 1.0;
  for (const int point : springs.points) matrix_.add_square({point}, &one, 2.0 * springs.point_weight);
  staying_ = matrix_.values();
  locked_ = springs.locked;
}

double HeldSystem::smoothness(const Points& d, Points* gradient) const {
  double sum = 0.0;
  for (const Difference& difference : differences_) {
    Eigen::RowVector2d value = Eigen::RowVector2d::Zero();
    for (std::size_t k = 0; k < difference.point.size(); ++k) {
      value += difference.coefficient[k] * d.row(difference.point[k]);
    }
    sum += smooth_ * value.squaredNorm();
    if (gradient == nullptr) continue;
    for (std::size_t k = 0; k < difference.point.size(); ++k) {
      gradient->row(difference.point[k]) += 2.0 * smooth_ * difference.coefficient[k] * value;
    }
  }
  return sum;
}

/// Adds a triangle's to the sum of its sub-cell, or to the matrix.
void HeldSystem::add(int triangle, const Jacobian& j, double weight) {
  Form own{};
  const bool apart = j.value() > near_collapse_;
  Form& sum = apart ? own : form_[at(cells_.cell[at(triangle)])];
  const Form form = j.form();
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t l = 0; l < 4; ++l) sum[k][l] += weight * form[k][l];
  }
  if (!apart) return;
  const Place place = place_of(shape_.triangles()[at(triangle)]);
  matrix_.add_form(place.block, place.gradient.data(), own);
}

void HeldSystem::factorize(const Points& u, double shape_weight) {
  matrix_.set_values(staying_);
  std::fill(form_.begin(), form_.end(), Form{});
  for (std::size_t t = 0; t < shape_.triangles().size(); ++t) {
    const HeldShape::Triangle& triangle = shape_.triangles()[t];
    add(static_cast<int>(t), triangle.jacobian(u), shape_weight * triangle.area);
  }
  finish();
}

void HeldSystem::factorize(const HeldSamples& samples, const Points& d, double shape_weight) {
  matrix_.set_values(staying_);
  std::fill(form_.begin(), form_.end(), Form{});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    add(samples.triangle(i), samples.jacobian(i, d), shape_weight * samples.area(i));
  }
  finish();
}

void HeldSystem::finish() {
  for (std::size_t c = 0; c < place_.size(); ++c) {
    if (form_[c][0][0] != 0.0) matrix_.add_form(place_[c].block, place_[c].gradient.data(), form_[c]);
  }
  const double scale = matrix_.scale();
  for (double more = regularization;; more *= 1e4) {
    matrix_.add_to_diagonal(more * scale);
    matrix_.fix(locked_);
    try {
      matrix_.factorize();
      return;
    } catch (const SolveError&) {
      if (more >= most_regularization) throw;
    }
  }
}

void HeldSystem::solve(const Points& gradient, Points& step) {
  side_ = -gradient;
  for (Eigen::Index p = 0; p < side_.rows(); ++p) {
    if (locked_[at(p)]) side_.row(p).setZero();
  }
  matrix_.solve(side_);
  step = side_;
}

}  // namespace planar
