// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/smoothing.h"

#include <array>
#include <cmath>

#include "mesh/triangle_shape.h"

namespace planar {
namespace {

/// Points stay so far inside of the outline, in sizes.
constexpr double kept_inside = 0.3;
/// Radians below this count so much more than others.
constexpr double small_angle = 30.0 * 3.14159265358979 / 180.0, dislike = 20.0;
/// Of steps in the search for a better place, from a quarter of the longest edge: to a sixtieth.
constexpr int step_halvings = 5;
/// Radians: wider than this all about a point there is nothing to gain.
constexpr double wide_angle = 52.0 * 3.14159265358979 / 180.0;

/// Rows of triangles round each point, one list after the other.
struct Stars {
  std::vector<int> first, triangle;

  explicit Stars(const PlanarMesh& mesh)
      : first(at(mesh.points.rows()) + 1, 0), triangle(at(mesh.triangles.size())) {
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) ++first[at(mesh.triangles.data()[i]) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<int> next(first.begin(), first.end() - 1);
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
      triangle[at(next[at(mesh.triangles.data()[i])]++)] = static_cast<int>(i / 3);
    }
  }
};

/// The smallest angle of a triangle, less for each degree below small_angle; far below all others where the
/// triangle is not counter-clockwise.
double worth(const Points& x, const int* corner) {
  if (doubled_area(x, corner) <= 0.0) return -1e3;
  double largest = -1.0;
  for (int c = 0; c < 3; ++c) {
    const Eigen::RowVector2d a = x.row(corner[(c + 1) % 3]) - x.row(corner[c]);
    const Eigen::RowVector2d b = x.row(corner[(c + 2) % 3]) - x.row(corner[c]);
    largest = std::max(largest, a.dot(b) / std::sqrt(a.squaredNorm() * b.squaredNorm()));
  }
  const double angle = std::acos(std::min(largest, 1.0));
  return angle - dislike * std::max(0.0, small_angle - angle);
}

}  // namespace

void smooth_towards_centroids(PlanarMesh& mesh, const Grid<float>& distance, const Grid<float>& size) {
  const Points before = mesh.points;
  Points sum = Points::Zero(before.rows(), 2);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(before.rows());
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const int* corner = mesh.triangles.data() + 3 * t;
    const Eigen::RowVector2d centroid =
        (before.row(corner[0]) + before.row(corner[1]) + before.row(corner[2])) / 3.0;
    const double s = sample(size, centroid[0], centroid[1]);
    const double weight = doubled_area(before, corner) / (s * s);
    for (int c = 0; c < 3; ++c) {
      sum.row(corner[c]) += weight * centroid;
      weights[corner[c]] += weight;
    }
  }
  for (Eigen::Index i = mesh.fixed; i < before.rows(); ++i) {
    if (weights[i] <= 0.0) continue;
    const Eigen::RowVector2d p = sum.row(i) / weights[i];
    if (sample(distance, p[0], p[1]) > kept_inside * sample(size, p[0], p[1])) mesh.points.row(i) = p;
  }
}

void widen_angles(PlanarMesh& mesh) {
  const Stars stars(mesh);
  for (Eigen::Index i = mesh.fixed; i < mesh.points.rows(); ++i) {
    const int first = stars.first[at(i)], end = stars.first[at(i) + 1];
    const auto total = [&] {
      double sum = 0.0;
      for (int k = first; k < end; ++k)
        sum += worth(mesh.points, mesh.triangles.data() + 3 * stars.triangle[at(k)]);
      return sum;
    };
    double best = total();
    if (best > wide_angle * (end - first)) continue;
    double length = 0.0;
    for (int k = first; k < end; ++k) {
      const int* corner = mesh.triangles.data() + 3 * stars.triangle[at(k)];
      for (int c = 0; c < 3; ++c)
        length = std::max(length, (mesh.points.row(corner[c]) - mesh.points.row(i)).norm());
    }
    constexpr std::array<std::array<int, 2>, 4> directions{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    double step = 0.25 * length;
    for (int halving = 0; halving < step_halvings; ++halving, step *= 0.5) {
      bool better = true;
      for (int round = 0; better && round < 8; ++round) {
        better = false;
        for (const auto& direction : directions) {
          const Eigen::RowVector2d old = mesh.points.row(i);
          mesh.points.row(i) += step * Eigen::RowVector2d(direction[0], direction[1]);
          const double now = total();
          if (now > best) {
            best = now;
            better = true;
          } else {
            mesh.points.row(i) = old;
          }
        }
      }
    }
  }
}

}  // namespace planar
