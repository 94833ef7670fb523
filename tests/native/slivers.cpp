// SPDX-License-Identifier: GPL-3.0-or-later
#include "slivers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace planar::testing {

double area_of(const Points& x, const std::array<int, 3>& t) {
  const Eigen::RowVector2d a = x.row(t[1]) - x.row(t[0]), b = x.row(t[2]) - x.row(t[0]);
  return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
}

namespace {

/// Splits vertex v of triangles that lie counter-clockwise: those of its fan from the one after neighbour
/// `from` on get a new vertex, `apart` away from it, and between the two fans is a needle; a second one where
/// the fan is closed. False if the fan is too small for it.
bool split_vertex(std::vector<Eigen::RowVector2d>& points, std::vector<std::array<int, 3>>& triangles, int v,
                  double apart) {
  std::map<int, std::pair<int, std::size_t>>
      next;  // of the fan: neighbour to neighbour, and the triangle's row
  std::map<int, int> before;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (triangles[t][c] != v) continue;
      const int a = triangles[t][(c + 1) % 3], b = triangles[t][(c + 2) % 3];
      if (!next.try_emplace(a, b, t).second || !before.try_emplace(b, a).second) return false;
    }
  }
  int first = next.begin()->first;
  const bool closed =
      std::all_of(next.begin(), next.end(), [&](const auto& n) { return before.count(n.first); });
  for (const auto& [a, n] : next) first = before.count(a) ? first : a;
  std::vector<int> around{first};  // counter-clockwise
  std::vector<std::size_t> rows;
  while (next.count(around.back())) {
    const auto [b, t] = next.at(around.back());
    rows.push_back(t);
    if (b == first) break;
    around.push_back(b);
  }
  if (rows.size() != next.size() || rows.size() < (closed ? 5U : 2U)) return false;
  // The first two triangles of a closed fan, or the first one of an open one, move over.
  const std::size_t moving = closed ? 2 : 1;
  const auto at = [&](int p) { return points[static_cast<std::size_t>(p)]; };
  Eigen::RowVector2d way = Eigen::RowVector2d::Zero();
  for (std::size_t i = 0; i <= moving; ++i) {
    const Eigen::RowVector2d side = at(around[i]) - at(v);
    if (side.norm() < 10.0 * apart) return false;
    way += side.normalized();
  }
  const int p = static_cast<int>(points.size());
  points.push_back(at(v) + apart * way.normalized());
  for (std::size_t i = 0; i < moving; ++i) {
    std::replace(triangles[rows[i]].begin(), triangles[rows[i]].end(), v, p);
  }
  triangles.push_back({v, p, around[moving]});
  if (closed) triangles.push_back({v, around[0], p});
  return true;
}

}  // namespace

Shape with_slivers(const Shape& shape, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<std::array<int, 3>> triangles;
  std::vector<double> areas;
  for (Eigen::Index t = 0; t < shape.triangles.rows(); ++t) {
    std::array<int, 3> corner{shape.triangles(t, 0), shape.triangles(t, 1), shape.triangles(t, 2)};
    const Eigen::RowVector2d a = shape.vertices.row(corner[1]) - shape.vertices.row(corner[0]);
    const Eigen::RowVector2d b = shape.vertices.row(corner[2]) - shape.vertices.row(corner[0]);
    if (a.x() * b.y() - a.y() * b.x() < 0.0) std::swap(corner[1], corner[2]);
    triangles.push_back(corner);
    areas.push_back(area_of(shape.vertices, corner));
  }
  std::nth_element(areas.begin(), areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2), areas.end());
  const double median = areas[areas.size() / 2];
  std::vector<Eigen::RowVector2d> points;
  for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) points.emplace_back(shape.vertices.row(v));
  const auto point = [&](int p) { return points[static_cast<std::size_t>(p)]; };
  const std::size_t wanted = triangles.size() / 6, first = triangles.size();
  while (triangles.size() < first + 2 * wanted) {
    const std::size_t t = random() % triangles.size();
    const auto [a, b, c] = triangles[t];
    const double kind = share(random);
    const double exponent = kind < 0.07   ? -17.0 + 4.0 * share(random)
                            : kind < 0.65 ? -13.0 + 8.0 * share(random)
                                          : -5.0 + 3.0 * share(random);
    const double area = std::pow(10.0, exponent) * median;
    const Eigen::RowVector2d along = point(b) - point(a);
    if (!(along.squaredNorm() > 0.1 * median)) continue;
    const double height = 2.0 * area / along.squaredNorm();  // of the length of the side
    const Eigen::RowVector2d up(-along.y(), along.x());
    if (height > 0.02 * (point(c) - point(a)).dot(up) / along.squaredNorm()) continue;
    if (share(random) < 0.5) {
      split_vertex(points, triangles, a, height * along.norm());
      continue;
    }
    const int p = static_cast<int>(points.size());
    points.emplace_back(point(a) + (0.2 + 0.6 * share(random)) * along + height * up);
    triangles[t] = {a, p, c};
    triangles.push_back({p, b, c});
    triangles.push_back({a, b, p});
  }
  Shape result{Points(static_cast<Eigen::Index>(points.size()), 2),
               Triangles(static_cast<Eigen::Index>(triangles.size()), 3)};
  for (std::size_t v = 0; v < points.size(); ++v)
    result.vertices.row(static_cast<Eigen::Index>(v)) = points[v];
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    result.triangles.row(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  }
  return result;
}

Drag random_drag(const Shape& shape, unsigned seed, double furthest) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  const std::size_t n_pins = 2 + random() % 6;
  const Points& x = shape.vertices;
  const double diagonal = (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm();
  Drag drag;
  Eigen::Index next = static_cast<Eigen::Index>(random() % static_cast<unsigned>(x.rows()));
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(x.rows(), 1e300);
  for (std::size_t i = 0; i <= n_pins; ++i) {
    if (i > 0) drag.pins.push_back(static_cast<int>(next));
    if (i == 1) distance.setConstant(1e300);
    distance = distance.cwiseMin((x.rowwise() - x.row(next)).rowwise().norm());
    distance.maxCoeff(&next);
  }
  drag.start = drag.targets = x(drag.pins, Eigen::all);
  for (Eigen::Index i = 0; i < drag.targets.rows(); i += 2) {
    Eigen::RowVector2d way;
    way.y() = value(random);  // one after the other: a call's arguments are drawn in no certain order
    way.x() = value(random);
    drag.targets.row(i) += furthest * diagonal * way;
  }
  return drag;
}

}  // namespace planar::testing
