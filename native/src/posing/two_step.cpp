// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/two_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/complex_product.h"
#include "base/complex_rows.h"
#include "base/index.h"
#include "linear/unknowns.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double brace_weight = 1e-3;  // as in energy/killing_energy.cpp
constexpr int worth_a_thread = 1000;   // vertices

Eigen::VectorXd with_braces(const Mesh& mesh, const Eigen::VectorXd& weight) {
  Eigen::VectorXd result(weight.size() + static_cast<Eigen::Index>(mesh.braces.size()));
  result.head(weight.size()) = weight;
  result.tail(static_cast<Eigen::Index>(mesh.braces.size())).setConstant(brace_weight);
  return result;
}

/// Of the length of `rest`, in the direction of `wanted` if it has one.
Complex turned(const Complex& rest, const Complex& wanted) {
  const double size = std::abs(wanted);
  return size > 0.0 ? wanted * (std::abs(rest) / size) : rest;
}

}  // namespace

template <class Solver>
TwoStep::System<Solver>::System(int n_vertices, const std::vector<std::array<int, 2>>& edges)
    : solver(Solver::create(default_backend())) {
  Unknowns all(*solver, edges, std::vector<char>(at(n_vertices), 1));
  matrix = all.zero<Number>();
  slot = std::move(all.slot);
  solver->analyze(matrix);
}

template <class Solver>
void TwoStep::System<Solver>::add(int a, int b, Number value) {
  const int i = slot[at(a)], j = slot[at(b)];
  if (i >= j) {
    matrix.value[at(matrix.find(i, j))] += value;
  } else {
    matrix.value[at(matrix.find(j, i))] += Eigen::numext::conj(value);
  }
}

template <class Solver>
void TwoStep::System<Solver>::factor(const std::vector<Pin>& pins, const std::vector<char>& active,
                                     const std::vector<int>& part) {
  matrix.value = without_pins;
  for (std::size_t v = 0; v < part.size(); ++v) {
    const bool solved = part[v] >= 0 && active[at(part[v])];
    if (!solved) add(static_cast<int>(v), static_cast<int>(v), 1.0);  // or else it would be singular
  }
  for (const Pin& pin : pins) {
    for (std::size_t a = 0; a < pin.n_corners; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        add(pin.vertex[a], pin.vertex[b], pin.strength * pin.weight[a] * pin.weight[b]);
      }
    }
  }
  solver->factorize(matrix);
}

TwoStep::System<HermitianSolver> TwoStep::make_similarity(const Mesh& mesh,
                                                          const std::vector<EdgeNeighbourhood>& hoods,
                                                          const Eigen::VectorXd& weight) {
  System<HermitianSolver> system(mesh.n_vertices, couplings(hoods));
  for (std::size_t k = 0; k < hoods.size(); ++k) {
    const std::array<Complex, 4> left = hoods[k].left();
    for (std::size_t m = 0; m < hoods[k].n_vertices; ++m) {
      for (std::size_t n = 0; n <= m; ++n) {
        system.add(hoods[k].vertex[m], hoods[k].vertex[n],
                   weight[static_cast<Eigen::Index>(k)] * product(std::conj(left[m]), left[n]));
      }
    }
  }
  system.without_pins = system.matrix.value;
  return system;
}

TwoStep::System<SparseSolver> TwoStep::make_scale(const Mesh& mesh,
                                                  const std::vector<EdgeNeighbourhood>& hoods,
                                                  const Eigen::VectorXd& weight) {
  std::vector<std::array<int, 2>> edges;
  edges.reserve(hoods.size());
  for (const EdgeNeighbourhood& hood : hoods) edges.push_back({hood.vertex[0], hood.vertex[1]});
  System<SparseSolver> system(mesh.n_vertices, edges);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const double w = weight[static_cast<Eigen::Index>(k)];
    system.add(edges[k][0], edges[k][0], w);
    system.add(edges[k][1], edges[k][1], w);
    system.add(edges[k][0], edges[k][1], -w);
  }
  system.without_pins = system.matrix.value;
  return system;
}

TwoStep::TwoStep(const Mesh& mesh, const RestOf& rest_of, const Eigen::VectorXd& weight)
    : n_edges_(mesh.edges.size()),
      part_(mesh.part),
      weight_(with_braces(mesh, weight)),
      hoods_(edge_neighbourhoods(mesh, rest_of)),
      similarity_(make_similarity(mesh, hoods_, weight_)),
      scale_(make_scale(mesh, hoods_, weight_)),
      unknown_(mesh.n_vertices),
      right_(mesh.n_vertices, 2),
      wanted_(hoods_.size()) {
  std::vector<int> count(n_edges_);
  for (int t = 0; t < static_cast<int>(mesh.triangles.rows()); ++t) {
    Triangle& triangle = triangles_.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const int k = mesh.find_edge(mesh.triangles(t, c), mesh.triangles(t, (c + 1) % 3));
      const auto [a, b] = mesh.edges[at(k)];
      const Eigen::Vector2d side = rest_of(t, b) - rest_of(t, a);
      triangle.edge[at(c)] = k;
      triangle.rest[at(c)] = complex_point(side.transpose());
      ++count[at(k)];
    }
  }
  for (Triangle& triangle : triangles_) {
    for (std::size_t c = 0; c < 3; ++c)
      triangle.weight[c] = weight_[triangle.edge[c]] / count[at(triangle.edge[c])];
  }
}

void TwoStep::factor(const std::vector<Pin>& pins, const std::vector<char>& active) {
  const auto factor_first = [&] { similarity_.factor(pins, active, part_); };
  if (part_.size() >= worth_a_thread) {
    worker_.start(factor_first);
  } else {
    factor_first();
  }
  try {
    scale_.factor(pins, active, part_);
  } catch (...) {
    worker_.wait();
    throw;
  }
  worker_.finish();
}

void TwoStep::similar(const std::vector<Pin>& pins, std::vector<Complex>& x) {
  unknown_.setZero();
  for (const Pin& pin : pins) {
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      unknown_[similarity_.slot[at(pin.vertex[c])]] +=
          pin.strength * pin.weight[c] * complex_point(pin.position);
    }
  }
  similarity_.solver->solve(unknown_, unknown_);
  x.resize(part_.size());
  for (std::size_t v = 0; v < x.size(); ++v) x[v] = unknown_[similarity_.slot[v]];
}

void TwoStep::adjust_scale(const std::vector<Pin>& pins, std::vector<Complex>& x) {
  for (std::size_t k = 0; k < hoods_.size(); ++k) {
    wanted_[k] = weight_[static_cast<Eigen::Index>(k)] * turned(hoods_[k].edge, hoods_[k].fitted(x.data()));
  }
  solve_for_edges(pins, x);
}

double TwoStep::iterate(const std::vector<Pin>& pins, std::vector<Complex>& x) {
  double energy = 0.0;
  std::fill(wanted_.begin(), wanted_.end(), 0.0);
  for (const Triangle& triangle : triangles_) {
    Complex sum = 0.0;
    std::array<Complex, 3> side;
    for (std::size_t c = 0; c < 3; ++c) {
      const EdgeNeighbourhood& hood = hoods_[at(triangle.edge[c])];
      side[c] = x[at(hood.vertex[1])] - x[at(hood.vertex[0])];
      sum += triangle.weight[c] * product(std::conj(triangle.rest[c]), side[c]);
    }
    const Complex turn = turned(1.0, sum);
    for (std::size_t c = 0; c < 3; ++c) {
      const Complex wanted = product(turn, triangle.rest[c]);
      energy += triangle.weight[c] * std::norm(side[c] - wanted);
      wanted_[at(triangle.edge[c])] += triangle.weight[c] * wanted;
    }
  }
  for (std::size_t k = n_edges_; k < hoods_.size(); ++k) {
    const Complex wanted = turned(hoods_[k].edge, hoods_[k].fitted(x.data()));
    energy += brace_weight * std::norm(x[at(hoods_[k].vertex[1])] - x[at(hoods_[k].vertex[0])] - wanted);
    wanted_[k] = brace_weight * wanted;
  }
  for (const Pin& pin : pins) {
    Complex left = -complex_point(pin.position);
    for (std::size_t c = 0; c < pin.n_corners; ++c) left += pin.weight[c] * x[at(pin.vertex[c])];
    energy += pin.strength * std::norm(left);
  }
  solve_for_edges(pins, x);
  return energy;
}

/// x of least Σ weight |(v_j - v_i) - wanted/weight|² + Σ strength |pin - target|².
void TwoStep::solve_for_edges(const std::vector<Pin>& pins, std::vector<Complex>& x) {
  right_.setZero();
  const auto add = [&](int v, double share, double re, double im) {
    const int row = scale_.slot[at(v)];
    right_(row, 0) += share * re;
    right_(row, 1) += share * im;
  };
  for (std::size_t k = 0; k < hoods_.size(); ++k) {
    add(hoods_[k].vertex[0], -1.0, wanted_[k].real(), wanted_[k].imag());
    add(hoods_[k].vertex[1], 1.0, wanted_[k].real(), wanted_[k].imag());
  }
  for (const Pin& pin : pins) {
    for (std::size_t c = 0; c < pin.n_corners; ++c)
      add(pin.vertex[c], pin.strength * pin.weight[c], pin.position.x(), pin.position.y());
  }
  std::as_const(*scale_.solver).solve(right_);
  for (std::size_t v = 0; v < x.size(); ++v) x[v] = {right_(scale_.slot[v], 0), right_(scale_.slot[v], 1)};
}

}  // namespace planar
