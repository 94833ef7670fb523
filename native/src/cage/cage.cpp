// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/cage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <utility>

#include "base/index.h"
#include "cage/coarsening.h"
#include "mesh/triangle_shape.h"

namespace planar {
namespace {

/// Of the mean diagonal: a spring along each edge, for how far its ends are from where the fit begins. Has
/// vertices follow their neighbours where hardly a dense one depends on them.
constexpr double regularisation = 1e-9;
/// Solves of the fit, each for what the one before leaves: takes out what the regularisation does.
constexpr int rounds = 2;

/// Of the size: coordinates beyond make float32 coarse beside a dense mesh's triangles.
constexpr double far_out = 10.0;
constexpr double weightless = 1e-9;  // barycentric, see Handles
constexpr double squeezed = 0.05;    // of the area at rest

std::array<double, 3> weights_of(const Place& place) {
  return {1.0 - place.first - place.second, place.first, place.second};
}

/// The rotation of a triangle from one shape of the cage to another, 1 where there is none.
std::complex<double> turn_of(const int* corner, const Points& from, const Points& to) {
  const auto side = [corner](const Points& x, int c) {
    return complex_row(x, corner[c]) - complex_row(x, corner[0]);
  };
  const std::complex<double> area =
      side(from, 1) * std::conj(side(from, 2)) - side(from, 2) * std::conj(side(from, 1));
  const std::complex<double> a =
      (side(to, 1) * std::conj(side(from, 2)) - side(to, 2) * std::conj(side(from, 1))) / area;
  const double length = std::abs(a);
  return length > 0.0 && std::isfinite(length) ? a / length : 1.0;
}

}  // namespace

Place place_in(const Points& rest, const Triangles& triangles, int triangle,
               const Eigen::RowVector2d& point) {
  const int* corner = triangles.data() + 3 * triangle;
  const Eigen::RowVector2d a = rest.row(corner[0]);
  const Eigen::RowVector2d u = rest.row(corner[1]) - a, v = rest.row(corner[2]) - a, p = point - a;
  const double area = u.x() * v.y() - u.y() * v.x();
  if (area == 0.0) return {triangle, 0.0, 0.0};
  return {triangle, (p.x() * v.y() - p.y() * v.x()) / area, (u.x() * p.y() - u.y() * p.x()) / area};
}

Handles caged(const Handles& handles, const Cage& cage, const Points& rest) {
  Handles result;
  result.vertices.resize(handles.size(), 3);
  result.weights.resize(handles.size(), 3);
  const Points points = handles.positions(rest);
  for (Eigen::Index row = 0; row < handles.size(); ++row) {
    Eigen::Index first = 0;
    handles.weights.row(row).maxCoeff(&first);
    Place best = cage.places[at(handles.vertices(row, first))];
    if (best.triangle < 0) {
      result.vertices.row(row).setConstant(cage.row_of(handles.vertices(row, first)));
      result.weights.row(row) << 1.0, 0.0, 0.0;
      continue;
    }
    double most = -std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) {
      if (std::abs(handles.weights(row, c)) <= weightless) continue;  // it may be any vertex
      const int triangle = cage.places[at(handles.vertices(row, c))].triangle;
      const Place place = place_in(cage.rest, cage.triangles, triangle, points.row(row));
      const double least = std::min({place.first, place.second, 1.0 - place.first - place.second});
      if (least <= most) continue;
      most = least;
      best = place;
    }
    result.vertices.row(row) = cage.triangles.row(best.triangle);
    result.weights.row(row) << 1.0 - best.first - best.second, best.first, best.second;
  }
  return result;
}

int Cage::row_of(int isolated_vertex) const {
  const auto found = std::lower_bound(isolated.begin(), isolated.end(), isolated_vertex);
  return static_cast<int>(rest.rows()) - static_cast<int>(isolated.end() - found);
}

std::optional<Coarse> coarse_for_cage(const Points& rest, const Triangles& triangles, int wished,
                                      const std::function<bool(double)>& progress) {
  if (rest.rows() <= wished) return {};
  Coarse coarse = coarsened(rest, triangles, wished, progress);
  if (2 * coarse.points.rows() > rest.rows()) return {};
  return coarse;
}

Cage make_cage(const Points& rest, Coarse coarse) {
  Cage cage{std::move(coarse.points), std::move(coarse.triangles), {}, {}, std::move(coarse.origins)};
  const std::vector<int>& owner = coarse.triangle_of;
  cage.places.reserve(owner.size());
  for (std::size_t v = 0; v < owner.size(); ++v) {
    cage.places.push_back(
        owner[v] < 0 ? Place{-1, 0.0, 0.0}
                     : place_in(cage.rest, cage.triangles, owner[v], rest.row(static_cast<Eigen::Index>(v))));
  }
  for (int v = 0; v < static_cast<int>(owner.size()); ++v) {
    if (owner[at(v)] >= 0) continue;
    cage.isolated.push_back(v);
    cage.origins.push_back({v, -1, -1});
  }
  const auto n_isolated = static_cast<Eigen::Index>(cage.isolated.size());
  cage.rest.conservativeResize(cage.rest.rows() + n_isolated, 2);
  cage.rest.bottomRows(n_isolated) = rest(cage.isolated, Eigen::all);
  return cage;
}

Suspects::Suspects(const Cage& cage, const Points& rest, const Triangles& triangles)
    : first_(planar::at(cage.triangles.rows()) + 1),
      far_(rest.cwiseAbs().maxCoeff() >
           far_out * (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).maxCoeff()) {
  const auto owner = [&](Eigen::Index t) {
    const int a = cage.places[planar::at(triangles(t, 0))].triangle;
    const bool one = a == cage.places[planar::at(triangles(t, 1))].triangle &&
                     a == cage.places[planar::at(triangles(t, 2))].triangle;
    return one ? a : -1;
  };
  std::vector<int> owners;
  owners.reserve(planar::at(triangles.rows()));
  for (int t = 0; t < static_cast<int>(triangles.rows()); ++t) {
    owners.push_back(owner(t));
    if (owners.back() < 0) {
      across_.push_back(t);
    } else {
      ++first_[planar::at(owners.back()) + 1];
    }
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  inside_.resize(owners.size() - across_.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int t = 0; t < static_cast<int>(owners.size()); ++t) {
    const int one = owners[planar::at(t)];
    if (one >= 0) inside_[planar::at(next[planar::at(one)]++)] = t;
  }
}

std::vector<int> Suspects::at(const Cage& cage, const Points& x, bool all) const {
  std::vector<int> result = across_;
  if (all || far_) {
    result.insert(result.end(), inside_.begin(), inside_.end());
    return result;
  }
  for (Eigen::Index t = 0; t < cage.triangles.rows(); ++t) {
    const int* corner = cage.triangles.data() + 3 * t;
    if (doubled_area(x, corner) > squeezed * doubled_area(cage.rest, corner)) continue;
    const auto begin = inside_.begin();
    result.insert(result.end(), begin + first_[planar::at(t)], begin + first_[planar::at(t) + 1]);
  }
  return result;
}

CageFit::CageFit(const Cage& cage, const Mesh& mesh)
    : cage_(cage),
      solver_(SparseSolver::create(default_backend())),
      unknowns_(*solver_, mesh.edges, std::vector<char>(at(mesh.n_vertices), 1)) {
  SymmetricMatrix matrix = unknowns_.zero<double>();
  for (const Place& place : cage.places) {
    if (place.triangle < 0) continue;
    const std::array<double, 3> weight = weights_of(place);
    for (int a = 0; a < 3; ++a) {
      const int i = unknowns_.slot[at(cage.triangles(place.triangle, a))];
      for (int b = 0; b < 3; ++b) {
        const int j = unknowns_.slot[at(cage.triangles(place.triangle, b))];
        if (i >= j) matrix.value[at(matrix.find(i, j))] += weight[at(a)] * weight[at(b)];
      }
    }
  }
  double mean = 0.0;
  for (int i = 0; i < unknowns_.size; ++i) mean += matrix.value[at(matrix.find(i, i))] / unknowns_.size;
  const double stiffness = regularisation * mean;
  for (const auto& [a, b] : mesh.edges) {
    const auto [j, i] = std::minmax(unknowns_.slot[at(a)], unknowns_.slot[at(b)]);
    matrix.value[at(matrix.find(i, j))] -= stiffness;
    matrix.value[at(matrix.find(i, i))] += stiffness;
    matrix.value[at(matrix.find(j, j))] += stiffness;
  }
  for (int i = 0; i < unknowns_.size; ++i) {
    double& diagonal = matrix.value[at(matrix.find(i, i))];
    if (diagonal == 0.0) diagonal = 1.0;  // isolated
  }
  solver_->analyze(matrix);
  solver_->factorize(matrix);
}

Points CageFit::fit(const Points& x) const {
  Points result(unknowns_.size, 2);
  for (Eigen::Index c = 0; c < result.rows(); ++c) {
    const auto [source, a, b] = cage_.origins[at(c)];
    result.row(c) = source >= 0 ? x.row(source).eval() : (0.5 * (result.row(a) + result.row(b))).eval();
  }
  RightSides right(unknowns_.size, 2);
  for (int round = 0; round < rounds; ++round) {
    right.setZero();
    for (std::size_t v = 0; v < cage_.places.size(); ++v) {
      const Place& place = cage_.places[v];
      if (place.triangle < 0) continue;
      const Eigen::RowVector2d left =
          x.row(static_cast<Eigen::Index>(v)) - carried(place, cage_.triangles, result);
      const std::array<double, 3> weight = weights_of(place);
      for (int c = 0; c < 3; ++c)
        right.row(unknowns_.slot[at(cage_.triangles(place.triangle, c))]) += weight[at(c)] * left;
    }
    solver_->solve(right);
    for (int c = 0; c < static_cast<int>(result.rows()); ++c)
      result.row(c) += right.row(unknowns_.slot[at(c)]);
  }
  return result;
}

CageSample::CageSample(const Cage& cage, const Points& rest, const Triangles& triangles) {
  std::vector<int> row(planar::at(rest.rows()), -1);
  for (int c = 0; c < static_cast<int>(cage.origins.size()); ++c) {
    const auto [source, a, b] = cage.origins[planar::at(c)];
    if (source >= 0) row[planar::at(source)] = c;
    const std::complex<double> from = source >= 0
                                          ? complex_row(rest, source)
                                          : 0.5 * (complex_row(cage.rest, a) + complex_row(cage.rest, b));
    beside_.push_back(complex_row(cage.rest, c) - from);
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const std::array<int, 3> corner{triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    const double area = doubled_area(rest, corner.data());
    if (area == 0.0) continue;
    for (const int v : corner) {
      if (row[planar::at(v)] < 0) continue;
      fans_.push_back({row[planar::at(v)], corner,
                       complex_row(rest, corner[1]) - complex_row(rest, corner[0]),
                       complex_row(rest, corner[2]) - complex_row(rest, corner[0]), area});
    }
  }
}

Points CageSample::at(const Cage& cage, const Points& x) const {
  using Complex = std::complex<double>;
  // What is round each vertex is deformed by z -> a z + b conj(z), in the mean.
  struct Deformation {
    Complex a, b;
    double weight = 0.0;
  };
  std::vector<Deformation> deformation(beside_.size());
  for (const Fan& fan : fans_) {
    const Complex u = complex_row(x, fan.corner[1]) - complex_row(x, fan.corner[0]);
    const Complex v = complex_row(x, fan.corner[2]) - complex_row(x, fan.corner[0]);
    Deformation& sum = deformation[planar::at(fan.row)];
    const Complex i(0.0, fan.area < 0.0 ? -0.5 : 0.5);
    sum.a += i * (u * std::conj(fan.second) - v * std::conj(fan.first));
    sum.b += i * (v * fan.first - u * fan.second);
    sum.weight += std::abs(fan.area);
  }
  Points result(static_cast<Eigen::Index>(beside_.size()), 2);
  for (std::size_t c = 0; c < beside_.size(); ++c) {
    const auto [source, a, b] = cage.origins[c];
    Deformation& own = deformation[c];
    Complex p = 0.0;
    if (source >= 0) {
      p = complex_row(x, source);
      own.a /= std::max(own.weight, std::numeric_limits<double>::min());
      own.b /= std::max(own.weight, std::numeric_limits<double>::min());
    } else {
      const Deformation &first = deformation[planar::at(a)], &second = deformation[planar::at(b)];
      p = 0.5 * (complex_row(result, a) + complex_row(result, b));
      own = {0.5 * (first.a + second.a), 0.5 * (first.b + second.b), 1.0};
    }
    p += own.a * beside_[c] + own.b * std::conj(beside_[c]);
    result.row(static_cast<Eigen::Index>(c)) << p.real(), p.imag();
  }
  return result;
}

Remainder::Remainder(const Cage& cage, const Points& fitted, const Points& x, double negligible) : left_(x) {
  double most = 0.0;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Place& place = cage.places[at(v)];
    if (place.triangle < 0) continue;
    left_.row(v) -= carried(place, cage.triangles, fitted);
    most = std::max(most, left_.row(v).squaredNorm());
  }
  largest_ = std::sqrt(most);
  if (largest_ > negligible) {
    fitted_ = fitted;
  } else {
    left_.resize(0, 2);
  }
}

Remainder::Turns Remainder::turns_to(const Cage& cage, const Points& x) const {
  Turns result;
  if (is_empty()) return result;
  result.reserve(at(cage.triangles.rows()));
  for (Eigen::Index t = 0; t < cage.triangles.rows(); ++t)
    result.push_back(turn_of(cage.triangles.data() + 3 * t, fitted_, x));
  return result;
}

}  // namespace planar
