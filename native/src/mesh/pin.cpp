// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/pin.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/checks.h"
#include "base/index.h"

namespace planar {

namespace {

constexpr double same_weights = 1e-9;  // barycentric weights of one and the same point, or none

bool same_point(const Pin& a, const Pin& b) {
  return a.n_corners == b.n_corners && a.vertex == b.vertex &&
         std::equal(a.weight.begin(), a.weight.end(), b.weight.begin(),
                    [](double p, double q) { return std::abs(p - q) <= same_weights; });
}

}  // namespace

Pin point_of(const Handles& handles, int row, int n_vertices, const std::function<bool(int, int)>& joined,
             const char* name) {
  Pin pin{};
  pin.rows = {row};
  std::array<std::pair<int, double>, 3> corner;
  for (int c = 0; c < 3; ++c) {
    const int v = handles.vertices(row, c);
    require_index(name, row, "vertex", v, n_vertices);
    corner[at(c)] = {v, handles.weights(row, c)};
  }
  if (!(std::abs(handles.weights.row(row).sum() - 1.0) <= same_weights)) {
    throw std::invalid_argument(row_of(name, row) + "the weights must sum to 1");
  }
  std::sort(corner.begin(), corner.end());
  for (const auto& [v, weight] : corner) {
    if (std::abs(weight) <= same_weights) continue;
    if (pin.n_corners > 0 && pin.vertex[pin.n_corners - 1] == v) {
      pin.weight[pin.n_corners - 1] += weight;
      continue;
    }
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      if (!joined(pin.vertex[c], v)) {
        throw std::invalid_argument(row_of(name, row) + "its vertices are not those of one triangle");
      }
    }
    pin.vertex[pin.n_corners] = v;
    pin.weight[pin.n_corners++] = weight;
  }
  return pin;
}

Pin point_of(const Mesh& mesh, const Handles& handles, int row, const char* name) {
  const auto joined = [&mesh](int a, int b) { return mesh.find_edge(a, b) >= 0; };
  Pin pin = point_of(handles, row, mesh.n_vertices, joined, name);
  pin.part = mesh.part[at(pin.vertex[0])];
  return pin;
}

std::vector<Pin> make_pins(const Mesh& mesh, const Handles& handles, const Eigen::VectorXd& weights,
                           const std::vector<char>& patch) {
  require_rows("handles.weights", handles.weights.rows(), handles.size(), "handle");
  std::vector<Pin> points;
  points.reserve(at(handles.size()));
  for (int row = 0; row < static_cast<int>(handles.size()); ++row) {
    points.push_back(point_of(mesh, handles, row));
    points.back().strength = weights[row];
    points.back().patch = !patch.empty() && patch[at(row)];
  }
  std::erase_if(points, [](const Pin& point) { return point.part < 0; });
  const auto where = [](const Pin& pin) {
    return std::tie(pin.n_corners, pin.vertex, pin.weight, pin.rows[0]);
  };
  std::sort(points.begin(), points.end(), [&](const Pin& a, const Pin& b) { return where(a) < where(b); });
  std::vector<Pin> pins;
  for (Pin& point : points) {
    if (pins.empty() || !same_point(pins.back(), point)) {
      pins.push_back(std::move(point));
      continue;
    }
    pins.back().rows.push_back(point.rows[0]);
    pins.back().strength = std::max(pins.back().strength, point.strength);
    pins.back().patch = pins.back().patch || point.patch;
  }
  return pins;
}

Eigen::RowVector2d pinned_point(const Pin& pin, const Points& x) {
  Eigen::RowVector2d p = Eigen::RowVector2d::Zero();
  for (std::size_t c = 0; c < pin.n_corners; ++c) p += pin.weight[c] * x.row(pin.vertex[c]);
  return p;
}

}  // namespace planar
