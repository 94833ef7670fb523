// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/log_spiral.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "checks.h"
#include "spirals.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

/// φ(z) = (e^z - 1)/z. The series is used as far as it is exact to the last bits with 12 terms: the closed
/// form loses digits to cancellation long after the paper's pole at 0.
Complex phi(Complex z) {
  if (std::norm(z) < 0.09) {
    Complex sum = 1.0 / 13.0;
    for (int k = 12; k > 1; --k) sum = (1.0 + z * sum) / static_cast<double>(k);
    return 1.0 + z * sum;
  }
  return (std::exp(z) - 1.0) / z;
}

}  // namespace

Spirals::Spirals(const Mesh& mesh)
    : edges_(mesh.edges),
      inverse_degree_(static_cast<std::size_t>(mesh.n_vertices)),
      x_(inverse_degree_.size()),
      velocity_(inverse_degree_.size()),
      z_(edges_.size()),
      phi_(inverse_degree_.size()) {
  for (const auto& edge : edges_) {
    for (const int v : edge) inverse_degree_[static_cast<std::size_t>(v)] += 1.0;
  }
  for (double& degree : inverse_degree_) degree = degree > 0.0 ? 1.0 / degree : 0.0;
}

double Spirals::prepare(const Points& x, const Points& velocities) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    x_[i] = {x(row, 0), x(row, 1)};
    velocity_[i] = {velocities(row, 0), velocities(row, 1)};
  }
  const double diagonal = (x.colwise().maxCoeff() - x.colwise().minCoeff()).squaredNorm();
  const double shortest = 1e-24 * diagonal;
  double largest = 0.0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const auto a = static_cast<std::size_t>(edges_[e][0]), b = static_cast<std::size_t>(edges_[e][1]);
    const Complex d = x_[a] - x_[b];
    z_[e] = std::norm(d) > shortest ? (velocity_[a] - velocity_[b]) / d : 0.0;
    largest = std::max(largest, std::norm(z_[e]));
  }
  return std::sqrt(largest);
}

void Spirals::advance(double t, Points& result) {
  t_ = t;
  std::fill(phi_.begin(), phi_.end(), 0.0);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Complex f = phi(t * z_[e]);
    for (const int v : edges_[e]) phi_[static_cast<std::size_t>(v)] += f;
  }
  result.resize(static_cast<Eigen::Index>(x_.size()), 2);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    phi_[i] *= inverse_degree_[i];
    place(i, result);
  }
}

void Spirals::share(const int* corner, Points& result) {
  Complex mean = 0.0;
  for (int c = 0; c < 3; ++c) mean += phi_[static_cast<std::size_t>(corner[c])] / 3.0;
  for (int c = 0; c < 3; ++c) {
    const auto i = static_cast<std::size_t>(corner[c]);
    phi_[i] = mean;
    place(i, result);
  }
}

void Spirals::place(std::size_t i, Points& result) const {
  const Complex p = x_[i] + t_ * velocity_[i] * phi_[i];
  result.row(static_cast<Eigen::Index>(i)) << p.real(), p.imag();
}

Points advance_along_spirals(const Points& vertices, const Triangles& triangles, const Points& velocities) {
  require_mesh("vertices", vertices, triangles);
  require_rows("velocities", velocities.rows(), vertices.rows(), "vertex");
  require_finite("velocities", velocities);
  Spirals spirals(Mesh(vertices.rows(), triangles));
  spirals.prepare(vertices, velocities);
  Points result;
  spirals.advance(1.0, result);
  if (!result.allFinite())
    throw SolveError("the velocities are too large: a spiral leaves the range of numbers");
  return result;
}

}  // namespace planar
