// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dense.h"
#include "energy/cotangent_weights.h"
#include "flatten/laplacian.h"
#include "flatten/patch.h"
#include "flatten/surfaces.h"
#include "flatten/tutte_map.h"
#include "flatten/two_steps.h"
#include "support.h"

namespace planar::testing {
namespace {

Surface bump() {
  return sheet(7, 6, 2.0, 1.5, [](double u, double v) {
    return Eigen::RowVector3d(u + 0.1 * std::sin(9.0 * v), v, 0.5 * std::sin(2.0 * u) * std::cos(3.0 * v));
  });
}

Eigen::VectorXd weights_of(const Patch& patch, bool cotangent) {
  if (!cotangent) return uniform_weights(patch.mesh);
  return cotangent_weights(patch.mesh, patch.rest_of());
}

/// [ARAP09] sections 4 and 7 read word by word, from positions in space, by dense least squares.
struct DenseTwoSteps {
  DenseTwoSteps(const SpacePoints& x, const Patch& patch, const Eigen::VectorXd& weight,
                std::array<int, 2> fixed) {
    const auto n = x.rows(), m = static_cast<Eigen::Index>(patch.mesh.edges.size());
    Eigen::MatrixXcd similar = Eigen::MatrixXcd::Zero(m, n), adjusted = similar, fit = similar;
    for (Eigen::Index e = 0; e < m; ++e) {
      const auto [a, b] = patch.mesh.edges[static_cast<std::size_t>(e)];
      std::vector<int> around{a, b};
      std::vector<Complex> place{0.0, (x.row(b) - x.row(a)).norm()};
      double side = 1.0;
      for (Eigen::Index t = 0; t < patch.mesh.triangles.rows(); ++t) {
        const Eigen::RowVector3i row = patch.mesh.triangles.row(t);
        if ((row.array() == a).any() && (row.array() == b).any()) {
          const int c = row.sum() - a - b;
          // Which side is which does not matter: the mirrored edge has the mirrored T, unless the other
          // edges have theirs the other way round. So take it from the order of the triangle's corners.
          const bool left =
              (row[0] == a && row[1] == b) || (row[1] == a && row[2] == b) || (row[2] == a && row[0] == b);
          side = left ? 1.0 : -1.0;
          const Eigen::RowVector3d ca = x.row(c) - x.row(a), ba = x.row(b) - x.row(a);
          const double angle = std::acos(ca.dot(ba) / (ca.norm() * ba.norm()));
          around.push_back(c);
          place.push_back(ca.norm() * Complex(std::cos(angle), side * std::sin(angle)));
        }
      }
      Complex mean = 0.0;
      for (const Complex p : place) mean += p / static_cast<double>(place.size());
      double square = 0.0;
      for (const Complex p : place) square += std::norm(p - mean);
      for (std::size_t i = 0; i < around.size(); ++i) fit(e, around[i]) = std::conj(place[i] - mean) / square;
      adjusted(e, b) = 1.0;
      adjusted(e, a) = -1.0;
      similar.row(e) = adjusted.row(e) - place[1] * fit.row(e);
      length.push_back(place[1].real());
    }
    Eigen::VectorXcd known = Eigen::VectorXcd::Zero(n);
    known[fixed[1]] = (x.row(fixed[0]) - x.row(fixed[1])).norm();
    std::vector<int> free;
    for (int v = 0; v < n; ++v) {
      if (v != fixed[0] && v != fixed[1]) free.push_back(v);
    }
    const Eigen::VectorXcd root = weight.cwiseSqrt().cast<Complex>();
    const auto solve = [&](const Eigen::MatrixXcd& rows, const Eigen::VectorXcd& right) {
      Eigen::VectorXcd z = known;
      const Eigen::MatrixXcd weighted = root.asDiagonal() * rows;
      const Eigen::VectorXcd left = root.cwiseProduct(right) - weighted * known;
      z(free) = least_squares(weighted(Eigen::all, free), left);
      return z;
    };
    const Eigen::VectorXcd first = solve(similar, Eigen::VectorXcd::Zero(m));
    Eigen::VectorXcd turned = fit * first;
    for (Eigen::Index e = 0; e < m; ++e)
      turned[e] *= length[static_cast<std::size_t>(e)] / std::abs(turned[e]);
    const Eigen::VectorXcd second = solve(adjusted, turned);
    steps[0] = points(first);
    steps[1] = points(second);
  }

  static Points points(const Eigen::VectorXcd& z) {
    Points x(z.size(), 2);
    x << z.real(), z.imag();
    return x;
  }

  std::vector<double> length;
  std::array<Points, 2> steps;
};

TEST(TwoSteps, AreTheDenseReadingOfThePaper) {
  const Surface surface = bump();
  const Patch patch(surface.vertices, surface.triangles);
  for (const bool cotangent : {false, true}) {
    const Eigen::VectorXd weight = weights_of(patch, cotangent);
    const std::array<int, 2> fixed = patch.central_edge();
    const TwoSteps steps(patch, weight, fixed);
    const DenseTwoSteps dense(surface.vertices, patch, weight, fixed);
    EXPECT_LT((steps.similar() - dense.steps[0]).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((steps.adjusted(steps.similar()) - dense.steps[1]).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(TutteMap, PutsVerticesAtTheMeanOfTheirNeighbours) {
  const Surface surface = bump();
  const Patch patch(surface.vertices, surface.triangles);
  const Points x = tutte_map(patch);
  const Mesh& mesh = patch.mesh;
  for (int v = 0; v < mesh.n_vertices; ++v) {
    if (!mesh.interior[static_cast<std::size_t>(v)]) {
      EXPECT_NEAR(x.row(v).norm(), std::sqrt(patch.area / 3.141592653589793), 1e-12);
      continue;
    }
    Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
    for (const auto& [a, b] : mesh.edges) {
      if (a == v) sum += x.row(b) - x.row(v);
      if (b == v) sum += x.row(a) - x.row(v);
    }
    EXPECT_LT(sum.norm(), 1e-12);
  }
}

// With equal weights triangles of the last rings have a size of 1e-60.
TEST(TutteMap, KeepsTheRingsOfLongSleeves) {
  const Surface surface = sleeve(6, 80);
  const Flatness found = flatness(surface, tutte_map(Patch(surface.vertices, surface.triangles)));
  EXPECT_EQ(found.flipped, 0);
  EXPECT_LT(found.area, 10.0);
}

TEST(Laplacian, IsThatOfDenseAlgebra) {
  const std::vector<std::array<int, 2>> edges{{0, 1}, {1, 2}, {2, 3}, {0, 2}, {1, 3}};
  const Eigen::VectorXd weight = Eigen::Vector<double, 5>(1.0, 2.0, 0.5, 3.0, 0.25);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(4, 4);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    const double w = weight[static_cast<Eigen::Index>(e)];
    dense(a, a) += w;
    dense(b, b) += w;
    dense(a, b) -= w;
    dense(b, a) -= w;
  }
  const Points force = random_points(4, 3);
  Points x = random_points(4, 5);
  const Points before = x;
  Laplacian(edges, weight, {1, 0, 1, 1}).solve(force, x);
  EXPECT_EQ(x.row(1), before.row(1));
  const Eigen::MatrixXd left = dense * x - force;
  for (const int v : {0, 2, 3}) EXPECT_LT(left.row(v).norm(), 1e-13);
}

}  // namespace
}  // namespace planar::testing
