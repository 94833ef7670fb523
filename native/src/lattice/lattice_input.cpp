// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/lattice_input.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/checks.h"
#include "base/index.h"
#include "lattice/weight_rows.h"

namespace planar {

namespace {

void require_weight(const char* name, double weight, bool above) {
  if (std::isfinite(weight) && (above ? weight > 0.0 : weight >= 0.0)) return;
  throw std::invalid_argument(std::string(name) + (above ? " must be a finite number above 0"
                                                         : " must be a finite number not below 0"));
}

void require_columns(const char* name, const Coordinates& rows, Eigen::Index expected) {
  if (rows.cols() == expected) return;
  throw std::invalid_argument(std::string(name) + " has " + std::to_string(rows.cols()) +
                              " columns, expected " + std::to_string(expected) + " as rest has");
}

}  // namespace

void require_model(const Coordinates& rest, const LatticeSolver::Elements& elements,
                   const LatticeWeights& weights, const Coordinates& lattice_rest) {
  if (rest.rows() == 0) throw std::invalid_argument("rest is empty");
  if (rest.cols() != 2 && rest.cols() != 3) {
    throw std::invalid_argument("rest has " + std::to_string(rest.cols()) + " columns, expected 2 or 3");
  }
  if (rest.rows() > most_rows) throw std::invalid_argument("rest: a mesh of this size is not supported");
  require_finite_rows("rest", rest);
  if (std::visit([](const auto& rows) { return rows.rows(); }, elements) == 0) {
    throw std::invalid_argument("elements is empty: a model needs at least one triangle or edge");
  }
  if (const auto* triangles = std::get_if<Triangles>(&elements)) require_triangles(rest.rows(), *triangles);
  if (lattice_rest.rows() == 0) throw std::invalid_argument("lattice_rest is empty");
  if (lattice_rest.rows() > most_rows) {
    throw std::invalid_argument("lattice_rest: a lattice of this size is not supported");
  }
  require_columns("lattice_rest", lattice_rest, rest.cols());
  require_finite_rows("lattice_rest", lattice_rest);
  require_rows("weights", weights.rows(), rest.rows(), "vertex");
  if (weights.cols() != lattice_rest.rows()) {
    throw std::invalid_argument("weights has " + std::to_string(weights.cols()) + " columns, expected " +
                                std::to_string(lattice_rest.rows()) + " (one per point of the lattice)");
  }
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    for (LatticeWeights::InnerIterator entry(weights, i); entry; ++entry) {
      if (!std::isfinite(entry.value()))
        throw std::invalid_argument(row_of("weights", i) + "not a finite number");
    }
  }
}

void require_options(const LatticeOptions& options, LatticeMethodKind method, bool triangles_in_2d) {
  if (method == LatticeMethodKind::hold && !triangles_in_2d) {
    throw std::invalid_argument("method: 'hold' needs triangles in two dimensions");
  }
  require_weight("weight_shape", options.weight_shape, true);
  if (options.weight_mesh) require_weight("weight_mesh", *options.weight_mesh, true);
  if (options.weight_lattice) require_weight("weight_lattice", *options.weight_lattice, true);
  if (options.weight_rest) require_weight("weight_rest", *options.weight_rest, false);
}

void require_handles(const LatticeHandles& handles, Eigen::Index n_vertices, Eigen::Index n_points) {
  for (Eigen::Index i = 0; i < handles.mesh.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      require_index("handles", i, "vertex", handles.mesh.vertices(i, c), n_vertices);
    if (!handles.mesh.weights.row(i).allFinite()) {
      throw std::invalid_argument(row_of("handles", i) + "not a finite number");
    }
  }
  if (handles.weights.size() != 0) {
    require_rows("weights", handles.weights.size(), handles.mesh.size(), "handle");
    require_positive("weights", handles.weights);
  }
  std::vector<char> seen(at(n_points), 0);
  const auto check = [&](const char* name, const Eigen::VectorXi& points) {
    for (Eigen::Index i = 0; i < points.size(); ++i) {
      require_index(name, i, "point", points[i], n_points);
      if (std::exchange(seen[at(points[i])], 1)) {
        throw std::invalid_argument(row_of(name, i) + "point " + std::to_string(points[i]) +
                                    " is named twice");
      }
    }
  };
  check("lattice_points", handles.lattice_points);
  check("locked", handles.locked);
}

void require_targets(const char* name, const Coordinates& targets, Eigen::Index rows, Eigen::Index columns) {
  require_rows(name, targets.rows(), rows, "handle");
  if (rows > 0) require_columns(name, targets, columns);
  require_finite_rows(name, targets);
}

LatticeWeights in_order(const LatticeWeights& weights) {
  std::vector<std::pair<int, double>> row;
  std::vector<int> start{0}, column;
  std::vector<double> value;
  column.reserve(at(weights.nonZeros()));
  value.reserve(at(weights.nonZeros()));
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    row.clear();
    for (LatticeWeights::InnerIterator entry(weights, i); entry; ++entry) {
      row.emplace_back(static_cast<int>(entry.col()), entry.value());
    }
    std::sort(row.begin(), row.end());
    for (std::size_t k = 0; k < row.size();) {
      double sum = 0.0;
      const int at_column = row[k].first;
      for (; k < row.size() && row[k].first == at_column; ++k) sum += row[k].second;
      if (sum == 0.0) continue;
      column.push_back(at_column);
      value.push_back(sum);
    }
    start.push_back(static_cast<int>(column.size()));
  }
  return of_rows(weights.cols(), start, column, value);
}

}  // namespace planar
