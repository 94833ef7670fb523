// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/ring_energy.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/index.h"
#include "lattice/difference_squares.h"
#include "lattice/nearest_rotation.h"

namespace planar {

namespace {

std::vector<int> all_vertices(Eigen::Index n) {
  std::vector<int> result(at(n));
  std::iota(result.begin(), result.end(), 0);
  return result;
}

}  // namespace

template <int D>
RingEnergy<D>::RingEnergy(const Rows<D>& rest, const LatticeWeights& weights, const WeightedEdges& edges)
    : RingEnergy(rest, weights, edges, all_vertices(rest.rows()), Eigen::VectorXd::Ones(rest.rows())) {}

template <int D>
RingEnergy<D>::RingEnergy(const Rows<D>& rest, const LatticeWeights& weights, const WeightedEdges& edges,
                          const std::vector<int>& centres, Eigen::VectorXd multiple)
    : multiple_(std::move(multiple)) {
  // The ends of each vertex's edges.
  std::vector<std::vector<std::pair<int, double>>> around(at(rest.rows()));
  std::vector<char> is_centre(at(rest.rows()), 0);
  for (const int centre : centres) is_centre[at(centre)] = 1;
  for (std::size_t e = 0; e < edges.edge.size(); ++e) {
    const auto [a, b] = edges.edge[e];
    const double weight = edges.weight[static_cast<Eigen::Index>(e)];
    if (is_centre[at(a)]) around[at(a)].emplace_back(b, weight);
    if (is_centre[at(b)]) around[at(b)].emplace_back(a, weight);
  }
  std::vector<int> number(at(rest.rows()), -1), chosen;
  const auto known = [&](int vertex) {
    int& n = number[at(vertex)];
    if (n < 0) {
      n = static_cast<int>(chosen.size());
      chosen.push_back(vertex);
    }
    return n;
  };
  for (const int centre : centres) centre_.push_back(known(centre));
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const double factor = multiple_[static_cast<Eigen::Index>(i)];
    for (const auto& [end, weight] : around[at(centres[i])]) {
      edges_.push_back({known(end), factor * weight});
    }
    start_.push_back(edges_.size());
  }
  weights_ = chosen_rows(weights, chosen);
  rest_ = rest(chosen, Eigen::all);
}

template <int D>
Eigen::VectorXd RingEnergy<D>::measures(const Rows<D>& rest, const WeightedEdges& edges) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(rest.rows());
  for (std::size_t e = 0; e < edges.edge.size(); ++e) {
    const auto [a, b] = edges.edge[e];
    const double measure =
        edges.weight[static_cast<Eigen::Index>(e)] * (rest.row(a) - rest.row(b)).squaredNorm();
    result[a] += measure;
    result[b] += measure;
  }
  return result;
}

template <int D>
void RingEnergy<D>::add_squares(PointMatrix& matrix, double factor) const {
  std::vector<WeightedPair> pairs;
  pairs.reserve(edges_.size());
  for (std::size_t ring = 0; ring < centre_.size(); ++ring) {
    for (std::size_t e = start_[ring]; e < start_[ring + 1]; ++e) {
      pairs.push_back({std::min(centre_[ring], edges_[e].to), std::max(centre_[ring], edges_[e].to),
                       factor * edges_[e].weight});
    }
  }
  add_difference_squares(weights_, std::move(pairs), matrix);
}

template <int D>
double RingEnergy<D>::value(const Rows<D>& d, Rows<D>* force) {
  using Row = Eigen::Matrix<double, 1, D>;
  product<D>(weights_, d, u_);
  if (force != nullptr) vertex_force_.setZero(u_.rows(), D);
  double sum = 0.0;
  for (std::size_t ring = 0; ring < centre_.size(); ++ring) {
    const int i = centre_[ring];
    const Row rest_i = rest_.row(i), u_i = u_.row(i);
    Eigen::Matrix<double, D, D> s = Eigen::Matrix<double, D, D>::Zero();
    for (std::size_t e = start_[ring]; e < start_[ring + 1]; ++e) {
      const Edge& edge = edges_[e];
      const Row before = rest_i - rest_.row(edge.to), after = before + (u_i - u_.row(edge.to));
      s.noalias() += (edge.weight * before).transpose() * after;
    }
    const Eigen::Matrix<double, D, D> turn = nearest_rotation(s);
    Row at_centre = Row::Zero();
    for (std::size_t e = start_[ring]; e < start_[ring + 1]; ++e) {
      const Edge& edge = edges_[e];
      const Row before = rest_i - rest_.row(edge.to), after = before + (u_i - u_.row(edge.to));
      const Row left = before * turn.transpose() - after;
      sum += edge.weight * left.squaredNorm();
      if (force == nullptr) continue;
      at_centre += edge.weight * left;
      vertex_force_.row(edge.to) -= edge.weight * left;
    }
    if (force != nullptr) vertex_force_.row(i) += at_centre;
  }
  if (force != nullptr) add_transposed<D>(weights_, vertex_force_, *force);
  return sum;
}

template <int D>
Motion<D> RingEnergy<D>::motion() const {
  return fit_motion<D>(rest_(centre_, Eigen::all), rest_(centre_, Eigen::all) + u_(centre_, Eigen::all),
                       multiple_);
}

template class RingEnergy<2>;
template class RingEnergy<3>;

}  // namespace planar
