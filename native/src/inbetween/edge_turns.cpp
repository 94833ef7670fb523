// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/edge_turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/complex_product.h"
#include "base/disjoint_sets.h"
#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr double full_turn = 2.0 * std::numbers::pi;

/// Angles that are being brought into line: sets of them agree with each other up to whole turns of the set.
class Alignment {
 public:
  explicit Alignment(const Eigen::VectorXd& angles)
      : angle_(angles), parent_(at(int(angles.size()))), turns_(parent_.size()), size_(parent_.size(), 1) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// Joins the sets of a and b, if they are two, by the least difference of these two angles.
  void join(int a, int b) {
    const auto [root_a, turns_a] = find(a);
    const auto [root_b, turns_b] = find(b);
    if (root_a == root_b) return;
    const double apart = (angle_[b] - angle_[a]) / full_turn;
    const double lift = turns_a - turns_b - std::round(apart);  // of b's set
    const bool under_a = size_[at(root_a)] >= size_[at(root_b)];
    const int child = under_a ? root_b : root_a, root = under_a ? root_a : root_b;
    parent_[at(child)] = root;
    turns_[at(child)] = under_a ? lift : -lift;
    size_[at(root)] += size_[at(child)];
  }

  double aligned(int i) const { return angle_[i] + full_turn * find(i).second; }

 private:
  std::pair<int, double> find(int i) const {
    double turns = 0.0;
    for (; parent_[at(i)] != i; i = parent_[at(i)]) turns += turns_[at(i)];
    return {i, turns};
  }

  const Eigen::VectorXd& angle_;
  std::vector<int> parent_;
  std::vector<double> turns_;  ///< of an entry relative to its parent
  std::vector<int> size_;
};

Complex side(const Points& x, int a, int b) { return {x(b, 0) - x(a, 0), x(b, 1) - x(a, 1)}; }

/// The mean of the two middle values, so that negated values have the negated median.
double median(std::vector<double>& values) {
  const auto upper = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), upper, values.end());
  if (values.size() % 2 == 1) return *upper;
  return (*upper + *std::max_element(values.begin(), upper)) / 2.0;
}

}  // namespace

double wrapped(double angle) { return angle - full_turn * std::round(angle / full_turn); }

Complex triangle_turn(Complex s1, Complex s2, Complex d1, Complex d2) {
  // The Jacobian is z -> αz + βz̄; the rotation of its polar decomposition is that of α.
  const double area = product(s1, std::conj(s2)).imag(), area_after = product(d1, std::conj(d2)).imag();
  if (!(area * area_after > 0.0)) {
    return product(d1, std::conj(s1)) + product(d2, std::conj(s2)) + product(d2 - d1, std::conj(s2 - s1));
  }
  const Complex numerator = product(d1, std::conj(s2)) - product(d2, std::conj(s1));
  return product(numerator, Complex(0.0, area > 0.0 ? -1.0 : 1.0));
}

EdgeTurns::EdgeTurns(const EdgeGraph& graph) : graph_(graph) {
  const Triangles& triangles = graph.triangles;
  if (triangles.rows() == 0) {
    for (const auto& edge : graph.edges) node_part_.push_back(graph.part[at(edge[0])]);
    std::vector<std::vector<int>> edges_at(graph.vertex_count());
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      for (const int v : graph.edges[i]) edges_at[at(v)].push_back(static_cast<int>(i));
    }
    for (const auto& edges : edges_at) {
      first_vertex_edge_.push_back(vertex_edge_.size());
      vertex_edge_.insert(vertex_edge_.end(), edges.begin(), edges.end());
    }
    first_vertex_edge_.push_back(vertex_edge_.size());
    return;
  }

  struct Side {
    std::pair<int, int> edge;
    int triangle;
    bool operator<(const Side& other) const {
      return edge != other.edge ? edge < other.edge : triangle < other.triangle;
    }
  };
  std::vector<Side> sides;
  std::vector<std::vector<int>> triangles_at(graph.vertex_count());
  for (int t = 0; t < static_cast<int>(triangles.rows()); ++t) {
    node_part_.push_back(graph.part[at(triangles(t, 0))]);
    for (int c = 0; c < 3; ++c) {
      sides.push_back({std::minmax(triangles(t, c), triangles(t, (c + 1) % 3)), t});
      triangles_at[at(triangles(t, c))].push_back(t);
    }
  }
  std::sort(sides.begin(), sides.end());  // the order of graph.edges
  links_.resize(2);
  DisjointSets connected(node_part_.size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].edge != sides[i - 1].edge) {
      first_edge_triangle_.push_back(i);
    } else {
      links_[0].push_back({sides[i - 1].triangle, sides[i].triangle});
      connected.join(sides[i - 1].triangle, sides[i].triangle);
    }
    edge_triangle_.push_back(sides[i].triangle);
  }
  first_edge_triangle_.push_back(sides.size());
  for (const auto& fans : triangles_at) {
    for (std::size_t i = 1; i < fans.size(); ++i) {
      if (connected.find(fans[i - 1]) != connected.find(fans[i])) links_[1].push_back({fans[i - 1], fans[i]});
    }
  }
}

Eigen::VectorXd EdgeTurns::of_triangles(const Points& from, const Points& to) const {
  Eigen::VectorXd angles(graph_.triangles.rows());
  for (Eigen::Index t = 0; t < angles.size(); ++t) {
    const int a = graph_.triangles(t, 0), b = graph_.triangles(t, 1), c = graph_.triangles(t, 2);
    const Complex s1 = side(from, a, b), s2 = side(from, a, c), d1 = side(to, a, b), d2 = side(to, a, c);
    angles[t] = std::arg(triangle_turn(s1, s2, d1, d2));
  }
  return angles;
}

/// Around a vertex the smallest differences are those between neighbours in the order of the angles, the last
/// of them and the first included; no other link can matter.
std::vector<EdgeTurns::Link> EdgeTurns::links_at_vertices(const Eigen::VectorXd& angles) const {
  std::vector<Link> links;
  std::vector<int> around;
  for (std::size_t v = 0; v < graph_.vertex_count(); ++v) {
    around.assign(vertex_edge_.begin() + static_cast<std::ptrdiff_t>(first_vertex_edge_[v]),
                  vertex_edge_.begin() + static_cast<std::ptrdiff_t>(first_vertex_edge_[v + 1]));
    std::sort(around.begin(), around.end(),
              [&angles](int a, int b) { return angles[a] != angles[b] ? angles[a] < angles[b] : a < b; });
    for (std::size_t i = 1; i < around.size(); ++i) links.push_back({around[i - 1], around[i]});
    if (around.size() > 2) links.push_back({around.back(), around.front()});
  }
  return links;
}

Eigen::VectorXd EdgeTurns::between(const Points& from, const Points& to) const {
  const bool mesh = graph_.triangles.rows() != 0;
  const auto n_edges = static_cast<Eigen::Index>(graph_.edges.size());
  Eigen::VectorXd own(n_edges);
  for (Eigen::Index i = 0; i < n_edges; ++i) {
    const auto edge = static_cast<std::size_t>(i);
    own[i] = std::arg(product(graph_.vector(edge, to), std::conj(graph_.vector(edge, from))));
  }
  const Eigen::VectorXd angles = mesh ? of_triangles(from, to) : own;

  Alignment alignment(angles);
  struct Candidate {
    double difference;
    std::size_t link;
    bool operator<(const Candidate& other) const {
      return difference != other.difference ? difference < other.difference : link < other.link;
    }
  };
  std::vector<Candidate> candidates;
  const auto propagate = [&](const std::vector<Link>& links) {
    candidates.clear();
    for (std::size_t i = 0; i < links.size(); ++i) {
      candidates.push_back({std::abs(wrapped(angles[links[i].b] - angles[links[i].a])), i});
    }
    std::sort(candidates.begin(), candidates.end());
    for (const Candidate& candidate : candidates) {
      alignment.join(links[candidate.link].a, links[candidate.link].b);
    }
  };
  if (mesh) {
    for (const auto& links : links_) propagate(links);
  } else {
    propagate(links_at_vertices(angles));
  }

  std::vector<double> aligned(node_part_.size());
  std::vector<std::vector<double>> of_part(at(graph_.n_parts));
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    aligned[i] = alignment.aligned(static_cast<int>(i));
    of_part[at(node_part_[i])].push_back(aligned[i]);
  }
  std::vector<double> whole_turns;
  whole_turns.reserve(of_part.size());
  for (auto& values : of_part) whole_turns.push_back(full_turn * std::round(median(values) / full_turn));
  for (std::size_t i = 0; i < aligned.size(); ++i) aligned[i] -= whole_turns[at(node_part_[i])];
  if (!mesh) return Eigen::Map<const Eigen::VectorXd>(aligned.data(), n_edges);

  Eigen::VectorXd turns(n_edges);
  for (Eigen::Index i = 0; i < n_edges; ++i) {
    const std::size_t first = first_edge_triangle_[static_cast<std::size_t>(i)],
                      end = first_edge_triangle_[static_cast<std::size_t>(i) + 1];
    double mean = 0.0;
    for (std::size_t k = first; k < end; ++k) mean += aligned[at(edge_triangle_[k])];
    mean /= static_cast<double>(end - first);
    turns[i] = mean + wrapped(own[i] - mean);
  }
  return turns;
}

}  // namespace planar
