// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/log_spiral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "base/checks.h"
#include "base/index.h"
#include "posing/spirals.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double series_radius = 0.3;
constexpr std::size_t block = 64;  // edges at a time

/// Terms of Σ zᵏ/(k+1)! that are needed for |z| up to `largest`: the first one left out is below 1e-17.
int n_terms(double largest) {
  int terms = 1;
  for (double term = 1.0; term > 1e-17; ++terms) term *= largest / (terms + 1);
  return terms;
}

/// φ(z) = (e^z - 1)/z of `count` numbers. Up to series_radius it is a series: the closed form loses digits to
/// cancellation long after the paper's pole at 0.
void phi(const double* z_real, const double* z_imag, double t, std::size_t count, double largest,
         double* real, double* imag) {
  if (largest < series_radius) {
    const int terms = n_terms(largest);
    std::fill_n(real, count, 1.0);
    std::fill_n(imag, count, 0.0);
    for (int k = terms; k > 1; --k) {
      const double scale = t / k;
      for (std::size_t i = 0; i < count; ++i) {
        const double x = scale * z_real[i], y = scale * z_imag[i];
        const double re = 1.0 + x * real[i] - y * imag[i];
        imag[i] = x * imag[i] + y * real[i];
        real[i] = re;
      }
    }
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Complex z(t * z_real[i], t * z_imag[i]);
    const double size = std::abs(z);
    if (size < series_radius) {
      phi(z_real + i, z_imag + i, t, 1, size, real + i, imag + i);
    } else {
      const Complex value = (std::exp(z) - 1.0) / z;
      real[i] = value.real();
      imag[i] = value.imag();
    }
  }
}

}  // namespace

Spirals::Spirals(const Mesh& mesh)
    : edges_(mesh.edges),
      inverse_degree_(at(mesh.n_vertices)),
      x_(inverse_degree_.size()),
      velocity_(inverse_degree_.size()),
      phi_(inverse_degree_.size()),
      z_real_(edges_.size()),
      z_imag_(edges_.size()) {
  for (const auto& edge : edges_) {
    for (const int v : edge) inverse_degree_[at(v)] += 1.0;
  }
  for (double& degree : inverse_degree_) degree = degree > 0.0 ? 1.0 / degree : 0.0;
}

double Spirals::prepare(const Points& x, const Points& velocities) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    x_[i] = {x(row, 0), x(row, 1)};
    velocity_[i] = {velocities(row, 0), velocities(row, 1)};
  }
  double longest = 0.0;
  for (const auto& [a, b] : edges_) longest = std::max(longest, std::norm(x_[at(a)] - x_[at(b)]));
  const double shortest = 1e-24 * longest;
  double largest = 0.0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const auto a = at(edges_[e][0]), b = at(edges_[e][1]);
    const Complex d = x_[a] - x_[b], u = velocity_[a] - velocity_[b];
    const double length = std::norm(d);
    // z = u/d = u·conj(d)/|d|², written out: the library's quotient takes care of ranges that the threshold
    // excludes.
    const double scale = length > shortest ? 1.0 / length : 0.0;
    z_real_[e] = (u.real() * d.real() + u.imag() * d.imag()) * scale;
    z_imag_[e] = (u.imag() * d.real() - u.real() * d.imag()) * scale;
    largest = std::max(largest, z_real_[e] * z_real_[e] + z_imag_[e] * z_imag_[e]);
  }
  return largest_ = std::sqrt(largest);
}

void Spirals::advance(double t, Points& result) {
  t_ = t;
  std::fill(phi_.begin(), phi_.end(), 0.0);
  std::array<double, block> real, imag;
  for (std::size_t first = 0; first < edges_.size(); first += block) {
    const std::size_t count = std::min(block, edges_.size() - first);
    phi(&z_real_[first], &z_imag_[first], t, count, t * largest_, real.data(), imag.data());
    for (std::size_t i = 0; i < count; ++i) {
      const Complex f(real[i], imag[i]);
      for (const int v : edges_[first + i]) phi_[at(v)] += f;
    }
  }
  result.resize(static_cast<Eigen::Index>(x_.size()), 2);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    phi_[i] *= inverse_degree_[i];
    place(i, result);
  }
}

void Spirals::share(const int* corner, Points& result) {
  Complex mean = 0.0;
  for (int c = 0; c < 3; ++c) mean += phi_[at(corner[c])] / 3.0;
  for (int c = 0; c < 3; ++c) {
    const auto i = at(corner[c]);
    phi_[i] = mean;
    place(i, result);
  }
}

void Spirals::place(std::size_t i, Points& result) const {
  // Products of complex numbers, written out: the operator's care for infinities costs calls.
  const double u = t_ * velocity_[i].real(), v = t_ * velocity_[i].imag();
  result(static_cast<Eigen::Index>(i), 0) = x_[i].real() + u * phi_[i].real() - v * phi_[i].imag();
  result(static_cast<Eigen::Index>(i), 1) = x_[i].imag() + u * phi_[i].imag() + v * phi_[i].real();
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
