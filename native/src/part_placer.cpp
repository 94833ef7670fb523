// SPDX-License-Identifier: GPL-3.0-or-later
#include "part_placer.h"

#include <cmath>
#include <numbers>
#include <string>

#include "checks.h"
#include "edge_turns.h"

namespace planar {

using Complex = std::complex<double>;

namespace {

Complex mean_of(const std::vector<int>& vertices, const auto& place_of) {
  Complex sum = 0.0;
  for (const int v : vertices) sum += place_of(v);
  return sum / static_cast<double>(vertices.size());
}

}  // namespace

PartPlacer::PartPlacer(const EdgeGraph& graph, const Eigen::VectorXi& anchor)
    : graph_(graph), anchors_(static_cast<std::size_t>(graph.n_parts)) {
  const auto add = [this](int vertex) {
    const int part = graph_.part[static_cast<std::size_t>(vertex)];
    if (part != -1) anchors_[static_cast<std::size_t>(part)].push_back(vertex);
  };
  for (Eigen::Index i = 0; i < anchor.size(); ++i) {
    if (anchor[i] < 0 || anchor[i] >= graph.n_vertices) {
      throw std::invalid_argument(row_of("anchor", i) + "vertex " + std::to_string(anchor[i]) +
                                  " is out of range, the shape has " + std::to_string(graph.n_vertices) +
                                  " vertices");
    }
    add(anchor[i]);
  }
  std::vector<char> held;
  for (const auto& vertices : anchors_) held.push_back(!vertices.empty());
  for (int v = 0; v < graph.n_vertices; ++v) {
    const int part = graph.part[static_cast<std::size_t>(v)];
    if (part != -1 && !held[static_cast<std::size_t>(part)]) add(v);
  }
}

Points PartPlacer::place(const ComplexRows& points, Eigen::Index column, const Points& from, const Points& to,
                         double u, const Course& course) const {
  std::vector<Complex> turn, origin;
  for (std::size_t p = 0; p < anchors_.size(); ++p) {
    turn.push_back(std::polar(1.0, u * course.turns[static_cast<Eigen::Index>(p)]));
    const double half = course.arc_turns[static_cast<Eigen::Index>(p)] / 2.0;
    // (e^{2iu·half} - 1) / (e^{2i·half} - 1): the share of the way, turned so that it lies on the arc.
    const Complex way = std::abs(half) < 1e-9
                            ? Complex(u)
                            : std::polar(1.0, half * (u - 1.0)) * (std::sin(half * u) / std::sin(half));
    const Complex start = mean_of(anchors_[p], [&](int v) { return Complex(from(v, 0), from(v, 1)); });
    const Complex end = mean_of(anchors_[p], [&](int v) { return Complex(to(v, 0), to(v, 1)); });
    const Complex here = mean_of(anchors_[p], [&](int v) { return points(v, column); });
    origin.push_back(start + way * (end - start) - turn.back() * here);
  }
  Points result(graph_.n_vertices, 2);
  for (int v = 0; v < graph_.n_vertices; ++v) {
    const int part = graph_.part[static_cast<std::size_t>(v)];
    if (part == -1) {
      result.row(v) = (1.0 - u) * from.row(v) + u * to.row(v);
    } else {
      const auto p = static_cast<std::size_t>(part);
      const Complex x = product(turn[p], points(v, column)) + origin[p];
      result.row(v) << x.real(), x.imag();
    }
  }
  return result;
}

void PartPlacer::hold_anchors(const Points& placed, Points& x) const {
  std::vector<Eigen::RowVector2d> shift;
  for (const auto& anchor : anchors_) {
    Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
    for (const int v : anchor) sum += placed.row(v) - x.row(v);
    shift.emplace_back(sum / static_cast<double>(anchor.size()));
  }
  for (int v = 0; v < graph_.n_vertices; ++v) {
    const int part = graph_.part[static_cast<std::size_t>(v)];
    if (part != -1) x.row(v) += shift[static_cast<std::size_t>(part)];
  }
}

Eigen::VectorXd PartPlacer::arcs(const Eigen::VectorXd& turns) {
  return turns.unaryExpr(
      [](double turn) { return std::abs(turn) < 1.5 * std::numbers::pi ? turn : wrapped(turn); });
}

}  // namespace planar
