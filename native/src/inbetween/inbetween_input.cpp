// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/inbetween_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/checks.h"
#include "base/diameter.h"
#include "base/disjoint_sets.h"

namespace planar {

namespace {

constexpr int most_turns = 100;

/// Sets of which one may stand for all transitions and none for empty ones.
template <typename Set>
std::vector<Set> for_transitions(const std::string& name, std::vector<Set> sets, std::size_t n_transitions) {
  if (sets.size() <= 1) sets.resize(n_transitions, sets.empty() ? Set() : Set(sets[0]));
  if (sets.size() != n_transitions) {
    throw std::invalid_argument(name + ": " + std::to_string(sets.size()) + " sets, expected 1 or " +
                                std::to_string(n_transitions) + " (one per pair of keys)");
  }
  return sets;
}

template <typename Set>
std::string name_of(const std::string& name, const std::vector<Set>& sets, std::size_t k) {
  return sets.size() == 1 ? name : name + "[" + std::to_string(k) + "]";
}

}  // namespace

void require_keys(const std::vector<Points>& keys) {
  if (keys.size() < 2) {
    throw std::invalid_argument("keys: at least two are needed, there are " + std::to_string(keys.size()));
  }
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const std::string name = "keys[" + std::to_string(k) + "]";
    require_rows(name.c_str(), keys[k].rows(), keys[0].rows(), "vertex of keys[0]");
    require_finite(name.c_str(), keys[k]);
  }
}

Eigen::VectorXd key_times_of(const std::vector<Points>& keys, const InbetweenOptions& options) {
  const auto n_keys = static_cast<Eigen::Index>(keys.size());
  if (options.key_times.size() == 0) {
    return Eigen::VectorXd::LinSpaced(n_keys, 0.0, static_cast<double>(n_keys - 1));
  }
  require_rows("key_times", options.key_times.size(), n_keys, "key");
  for (Eigen::Index k = 0; k < n_keys; ++k) {
    if (!std::isfinite(options.key_times[k])) {
      throw std::invalid_argument(row_of("key_times", k) + "not a finite number");
    }
    if (k > 0 && options.key_times[k] <= options.key_times[k - 1]) {
      throw std::invalid_argument(row_of("key_times", k) + "must be after the one before");
    }
    if (k > 0 && !std::isfinite(options.key_times[k] - options.key_times[k - 1])) {
      throw std::invalid_argument(row_of("key_times", k) + "too far from the one before");
    }
  }
  return options.key_times;
}

void require_iteration(const InbetweenOptions& options) {
  if (!std::isfinite(options.tolerance) || options.tolerance <= 0.0) {
    throw std::invalid_argument("tolerance must be a finite number above 0");
  }
  if (options.max_iterations < 1) throw std::invalid_argument("max_iterations must be at least 1");
  require_cage(options.cage);
  if (options.threads < 0) throw std::invalid_argument("threads must not be negative");
}

std::vector<Points> references_of(const std::vector<Points>& keys, const InbetweenOptions& options) {
  if (options.rest.rows() == 0) return keys;
  require_rows("rest", options.rest.rows(), keys[0].rows(), "vertex of keys[0]");
  require_finite("rest", options.rest);
  return {options.rest};
}

double size_of(const std::vector<Points>& shapes) {
  double size = 0.0;
  for (const Points& shape : shapes) size = std::max(size, diameter(shape));
  return std::numbers::sqrt2 * size;
}

Eigen::VectorXd frozen_weights(const EdgeGraph& graph, const std::vector<Points>& shapes) {
  Eigen::VectorXd length = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(graph.edges.size()));
  for (const Points& shape : shapes) {
    for (Eigen::Index i = 0; i < length.size(); ++i) {
      length[i] += std::abs(graph.vector(static_cast<std::size_t>(i), shape));
    }
  }
  const double mean = length.mean();
  if (!(mean > 0.0)) return Eigen::VectorXd::Ones(length.size());
  // Only ratios matter; this scale keeps the numbers near 1 whatever the unit.
  return mean * length.cwiseMax(1e-4 * mean).cwiseInverse();
}

Eigen::MatrixXi turns_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                         const InbetweenOptions& options) {
  const Eigen::MatrixXi& turns = options.turns;
  const auto n_transitions = static_cast<Eigen::Index>(keys.size()) - 1;
  const int n_parts = graph.n_parts;
  if (turns.size() == 0) return Eigen::MatrixXi::Zero(n_transitions, n_parts);
  require_rows("turns", turns.rows(), n_transitions, "pair of keys");
  if (turns.cols() != 1 && turns.cols() != n_parts) {
    throw std::invalid_argument("turns has " + std::to_string(turns.cols()) + " columns, expected 1 or " +
                                std::to_string(n_parts) + " (one per part)");
  }
  for (Eigen::Index k = 0; k < turns.rows(); ++k) {
    if (turns.row(k).maxCoeff() > most_turns || turns.row(k).minCoeff() < -most_turns) {
      throw std::invalid_argument(row_of("turns", k) + "more than " + std::to_string(most_turns) + " turns");
    }
  }
  return turns.cols() == n_parts ? turns : turns.replicate(1, n_parts).eval();
}

std::vector<Eigen::VectorXi> anchors_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                                        const InbetweenOptions& options) {
  auto anchors = for_transitions("anchor", options.anchors, keys.size() - 1);
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const std::string name = name_of("anchor", options.anchors, k);
    for (Eigen::Index i = 0; i < anchors[k].size(); ++i)
      require_index(name.c_str(), i, "vertex", anchors[k][i], graph.n_vertices);
  }
  return anchors;
}

std::vector<Edges> joints_of(const EdgeGraph& graph, const std::vector<Points>& keys,
                             const InbetweenOptions& options) {
  auto joints = for_transitions("joints", options.joints, keys.size() - 1);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    DisjointSets together(static_cast<std::size_t>(graph.n_parts));
    std::vector<char> carried(static_cast<std::size_t>(graph.n_parts));
    const std::string name = name_of("joints", options.joints, k);
    for (Eigen::Index i = 0; i < joints[k].rows(); ++i) {
      const std::string where = row_of(name.c_str(), i);
      std::array<int, 2> part{};
      for (const int side : {0, 1}) {
        const int vertex = joints[k](i, side);
        require_index(name.c_str(), i, "vertex", vertex, graph.n_vertices);
        part[static_cast<std::size_t>(side)] = graph.part[static_cast<std::size_t>(vertex)];
        if (graph.part[static_cast<std::size_t>(vertex)] == -1) {
          throw std::invalid_argument(where + "vertex " + std::to_string(vertex) + " belongs to no part");
        }
      }
      char& taken = carried[static_cast<std::size_t>(part[1])];
      if (taken) throw std::invalid_argument(where + "the part is carried by another one already");
      if (!together.join(part[0], part[1]))
        throw std::invalid_argument(where + "the part would carry itself");
      taken = 1;
    }
  }
  return joints;
}

Eigen::VectorXd mean_turns(const EdgeGraph& graph, const Eigen::VectorXd& turns, const Points& from,
                           const Points& to) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(graph.n_parts), weight = sum;
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const int part = graph.part[static_cast<std::size_t>(graph.edges[i][0])];
    const double length = std::abs(graph.vector(i, from)) + std::abs(graph.vector(i, to));
    sum[part] += length * turns[static_cast<Eigen::Index>(i)];
    weight[part] += length;
  }
  return sum.cwiseQuotient(weight.cwiseMax(std::numeric_limits<double>::min()));
}

}  // namespace planar
