// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten/surfaces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <vector>

#include "base/complex_rows.h"
#include "mesh/triangle_shape.h"

namespace planar::testing {

Points unrolled_sheet(int columns, int rows, double width, double height) {
  Points x(columns * rows, 2);
  for (int i = 0; i < columns * rows; ++i) {
    x.row(i) << width * (i % columns) / (columns - 1), height * (i / columns) / (rows - 1);
  }
  return x;
}

Surface sheet(int columns, int rows, double width, double height, const Embedding& embed) {
  const Points flat = unrolled_sheet(columns, rows, width, height);
  Surface result{SpacePoints(flat.rows(), 3), Triangles(2 * (columns - 1) * (rows - 1), 3)};
  for (Eigen::Index v = 0; v < flat.rows(); ++v) result.vertices.row(v) = embed(flat(v, 0), flat(v, 1));
  int t = 0;
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i;
      result.triangles.row(t++) << a, a + 1, a + columns;
      result.triangles.row(t++) << a + 1, a + columns + 1, a + columns;
    }
  }
  return result;
}

Surface cap(int rings, double angle) {
  std::vector<Eigen::RowVector3d> vertices{{0.0, 0.0, 1.0}};
  std::vector<Eigen::RowVector3i> triangles;
  std::vector<int> first{0};
  for (int ring = 1; ring <= rings; ++ring) {
    first.push_back(static_cast<int>(vertices.size()));
    const double polar = angle * ring / rings;
    for (int i = 0; i < 6 * ring; ++i) {
      const double a = 2.0 * std::numbers::pi * i / (6 * ring);
      vertices.emplace_back(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar));
    }
    const int outer = first.back(), inner = first[first.size() - 2], n_inner = std::max(1, 6 * (ring - 1));
    for (int sector = 0, i = 0; sector < 6; ++sector) {
      for (int step = 0; step < ring; ++step, ++i) {
        const int below = inner + (sector * (ring - 1) + step) % n_inner;
        triangles.emplace_back(below, outer + i, outer + (i + 1) % (6 * ring));
        if (step + 1 == ring) continue;
        triangles.emplace_back(below, outer + i + 1, inner + (sector * (ring - 1) + step + 1) % n_inner);
      }
    }
  }
  Surface result{SpacePoints(vertices.size(), 3), Triangles(triangles.size(), 3)};
  for (std::size_t i = 0; i < vertices.size(); ++i) result.vertices.row(static_cast<int>(i)) = vertices[i];
  for (std::size_t i = 0; i < triangles.size(); ++i) result.triangles.row(static_cast<int>(i)) = triangles[i];
  return result;
}

Surface sleeve(int around, int rings) {
  Surface result{SpacePoints(around * rings + 1, 3), Triangles(around * (2 * rings - 1), 3)};
  const double edge = 2.0 * std::sin(std::numbers::pi / around);
  int t = 0;
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      const double a = 2.0 * std::numbers::pi * i / around;
      const int v = ring * around + i, next = ring * around + (i + 1) % around;
      result.vertices.row(v) << std::cos(a), std::sin(a), edge * ring;
      if (ring + 1 < rings) {
        result.triangles.row(t++) << v, next, v + around;
        result.triangles.row(t++) << next, next + around, v + around;
      } else {
        result.triangles.row(t++) << v, next, around * rings;
      }
    }
  }
  result.vertices.row(around * rings) << 0.0, 0.0, edge * rings;
  return result;
}

Surface without(const Surface& surface, const std::function<bool(int)>& left_out) {
  std::vector<Eigen::RowVector3i> kept;
  std::vector<int> number(static_cast<std::size_t>(surface.vertices.rows()), -1);
  for (int t = 0; t < surface.triangles.rows(); ++t) {
    if (!left_out(t)) kept.emplace_back(surface.triangles.row(t));
  }
  Surface result{SpacePoints(surface.vertices.rows(), 3), Triangles(kept.size(), 3)};
  int n = 0;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      int& v = number[static_cast<std::size_t>(kept[t][c])];
      if (v < 0) {
        v = n++;
        result.vertices.row(v) = surface.vertices.row(kept[t][c]);
      }
      result.triangles(static_cast<Eigen::Index>(t), c) = v;
    }
  }
  result.vertices.conservativeResize(n, 3);
  return result;
}

Surface cut(const Surface& surface, const std::vector<int>& path) {
  Surface result = surface;
  const auto corner = [&result](Eigen::Index t, int v) {
    for (int c = 0; c < 3; ++c) {
      if (result.triangles(t, c) == v) return c;
    }
    return -1;
  };
  // Triangles to the left of the path get the doubles: the fans round its vertices, from one of its edges to
  // the next.
  std::set<std::array<Eigen::Index, 2>> doubled;  // triangle, corner
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const int v = path[i], next = path[i + 1], last = i == 0 ? -1 : path[i - 1];
    for (int from = next; from != last;) {
      int onward = -1;
      for (Eigen::Index t = 0; t < surface.triangles.rows() && onward < 0; ++t) {
        const int c = corner(t, v);
        if (c < 0 || result.triangles(t, (c + 1) % 3) != from) continue;
        doubled.insert({t, c});
        onward = result.triangles(t, (c + 2) % 3);
      }
      if (onward < 0) break;
      from = onward;
    }
  }
  Eigen::Index n = result.vertices.rows();
  result.vertices.conservativeResize(n + static_cast<Eigen::Index>(path.size()) - 1, 3);
  for (std::size_t i = 0; i + 1 < path.size(); ++i, ++n) {
    result.vertices.row(n) = surface.vertices.row(path[i]);
    for (const auto& [t, c] : doubled) {
      if (surface.triangles(t, c) == path[i]) result.triangles(t, c) = static_cast<int>(n);
    }
  }
  return result;
}

Flatness flatness(const Surface& surface, const Points& x) {
  const Flags flat = flat_triangles(surface.vertices, surface.triangles);
  Flatness result{0.0, 0.0, 0};
  double total = 0.0;
  const Points rounded = x.cast<float>().cast<double>();
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (flat[t]) continue;
    const auto row = surface.triangles.row(t);
    const Eigen::RowVector3d u = surface.vertices.row(row[1]) - surface.vertices.row(row[0]);
    const Eigen::RowVector3d v = surface.vertices.row(row[2]) - surface.vertices.row(row[0]);
    Eigen::Matrix2d rest, now;
    rest << u.norm(), u.dot(v) / u.norm(), 0.0, u.cross(v).norm() / u.norm();
    now.col(0) = x.row(row[1]) - x.row(row[0]);
    now.col(1) = x.row(row[2]) - x.row(row[0]);
    result.flipped += !(doubled_area(rounded, surface.triangles.data() + 3 * t) > 0.0);
    const double weight = rest(0, 0) * rest(1, 1);
    const double scale = std::abs(now(0, 0) * now(1, 1) - now(0, 1) * now(1, 0)) / weight;
    const double ax = now(0, 0) / rest(0, 0), ay = now(1, 0) / rest(0, 0);
    const double bx = (now(0, 1) - ax * rest(0, 1)) / rest(1, 1);
    const double by = (now(1, 1) - ay * rest(0, 1)) / rest(1, 1);
    result.area += weight * (scale + 1.0 / scale);
    result.angle += weight * (ax * ax + ay * ay + bx * bx + by * by) / scale;
    total += weight;
  }
  result.area /= total;
  result.angle /= total;
  return result;
}

double apart(const Points& x, const Points& y) {
  const Points p = x.rowwise() - x.colwise().mean(), q = y.rowwise() - y.colwise().mean();
  std::complex<double> turn = 0.0;
  for (Eigen::Index v = 0; v < p.rows(); ++v) turn += std::conj(complex_row(p, v)) * complex_row(q, v);
  turn /= std::abs(turn);
  double result = 0.0;
  for (Eigen::Index v = 0; v < p.rows(); ++v) {
    result = std::max(result, std::abs(turn * complex_row(p, v) - complex_row(q, v)));
  }
  return result;
}

}  // namespace planar::testing
