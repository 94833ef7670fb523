// SPDX-License-Identifier: GPL-3.0-or-later
#include "cage/half_edges.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/triangle_shape.h"

namespace planar {

HalfEdges::HalfEdges(const Points& points, const Triangles& triangles)
    : corner_(triangles.data(), triangles.data() + triangles.size()),
      twin_(corner_.size(), -1),
      out_(at(points.rows()), -1),
      fixed_(out_.size()),
      seen_(out_.size()) {
  turn_counter_clockwise(points);
  join_twins();
  find_fixed();
}

/// Those that are too thin to tell lie as most do in the order that was given.
void HalfEdges::turn_counter_clockwise(const Points& points) {
  constexpr double thin = 1e-9;  // of the squared longest side
  std::vector<std::size_t> unsure;
  Eigen::Index excess = 0;  // of those that are counter-clockwise
  for (std::size_t t = 0; t < corner_.size(); t += 3) {
    const int* corner = corner_.data() + t;
    const double area = doubled_area(points, corner);
    double longest = 0.0;
    for (int c = 0; c < 3; ++c)
      longest = std::max(longest, (points.row(corner[c]) - points.row(corner[(c + 1) % 3])).squaredNorm());
    if (!(std::abs(area) > thin * longest)) {
      unsure.push_back(t);
      continue;
    }
    excess += area > 0.0 ? 1 : -1;
    if (area < 0.0) std::swap(corner_[t + 1], corner_[t + 2]);
  }
  if (excess >= 0) return;
  for (const std::size_t t : unsure) std::swap(corner_[t + 1], corner_[t + 2]);
}

/// Pairs the half-edges that go there and back between two vertices; where there are others, none.
void HalfEdges::join_twins() {
  const auto n_half_edges = static_cast<int>(corner_.size());
  std::vector<int> first(out_.size() + 1), by_lower(corner_.size());
  const auto lower = [this](int h) { return std::min(origin(h), target(h)); };
  for (int h = 0; h < n_half_edges; ++h) ++first[at(lower(h)) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<int> place(first.begin(), first.end() - 1);
  for (int h = 0; h < n_half_edges; ++h) by_lower[at(place[at(lower(h))]++)] = h;
  for (int a = 0; a < n_vertices(); ++a) {
    const auto begin = by_lower.begin() + first[at(a)], end = by_lower.begin() + first[at(a) + 1];
    const auto upper = [this](int h) { return std::max(origin(h), target(h)); };
    std::sort(begin, end, [&](int g, int h) { return std::pair(upper(g), g) < std::pair(upper(h), h); });
    for (auto h = begin; h != end;) {
      const auto after = std::find_if(h, end, [&](int other) { return upper(other) != upper(*h); });
      if (after - h == 2 && origin(h[0]) == target(h[1])) {
        twin_[at(h[0])] = h[1];
        twin_[at(h[1])] = h[0];
      } else if (after - h > 1) {
        fixed_[at(a)] = fixed_[at(upper(*h))] = 1;
      }
      h = after;
    }
  }
}

void HalfEdges::find_fixed() {
  std::vector<int> n_fan(out_.size());
  for (int h = 0; h < static_cast<int>(corner_.size()); ++h) {
    ++n_fan[at(origin(h))];
    if (out(origin(h)) < 0 || twin(h) < 0) out_[at(origin(h))] = h;
  }
  for (int v = 0; v < n_vertices(); ++v) {
    if (out(v) < 0 || fixed_[at(v)]) continue;
    int count = 0;
    for_fan(v, [&count](int) { ++count; });
    if (count != n_fan[at(v)]) fixed_[at(v)] = 1;
  }
}

/// Has a vertex begin its fan where it should, given any half-edge out of it.
void HalfEdges::set_out(int vertex, int h) {
  const int start = h;
  while (twin(h) >= 0) {
    h = next(twin(h));
    if (h == start) break;
  }
  out_[at(vertex)] = h;
}

bool HalfEdges::can_collapse(const Side& side) {
  const auto [u, v, there, back] = side;
  if (is_fixed(u) || is_fixed(v)) return false;
  const bool rim = there < 0 || back < 0;
  if (is_boundary(u) && !rim) return false;
  for (const int h : {there, back}) {
    // A corner with no other triangle would be lost.
    if (h >= 0 && twin(next(h)) < 0 && twin(previous(h)) < 0) return false;
  }
  ++pass_;
  for_sides(v, [this](const Side& other) { seen_[at(other.v)] = pass_; });
  int shared = 0;
  for_sides(u, [this, &shared](const Side& other) { shared += seen_[at(other.v)] == pass_; });
  return shared == (there >= 0) + (back >= 0);
}

void HalfEdges::collapse(const Side& side) {
  const auto [u, v, there, back] = side;
  fan_.clear();
  for_fan(u, [this](int h) { fan_.push_back(h); });
  for (const int h : fan_) corner_[at(h)] = v;

  int any = -1;  // a half-edge out of v
  std::array<std::array<int, 2>, 2> apex{{{-1, -1}, {-1, -1}}};
  std::size_t n_apex = 0;
  for (const int h : {there, back}) {
    if (h < 0) continue;
    // The triangle's two other sides become one.
    const int ahead = twin(next(h)), behind = twin(previous(h));
    const int tip = origin(previous(h));
    if (ahead >= 0) twin_[at(ahead)] = behind;
    if (behind >= 0) twin_[at(behind)] = ahead;
    // Of `ahead` the origin is the tip; after `behind` comes it.
    apex[n_apex++] = {tip, ahead >= 0 ? ahead : next(behind)};
    const int from_end = ahead >= 0 ? next(ahead) : -1;
    // `there`: ahead leads from the tip to v, behind from u to the tip; `back` likewise, with u and v
    // changed.
    any = behind >= 0 ? behind : from_end;
    const int t = h - h % 3;
    for (int c = t; c < t + 3; ++c) corner_[at(c)] = twin_[at(c)] = -1;
  }
  out_[at(u)] = -1;
  set_out(v, any);
  for (std::size_t i = 0; i < n_apex; ++i) set_out(apex[i][0], apex[i][1]);
}

bool HalfEdges::can_flip(int h) const {
  const int back = twin(h);
  if (back < 0) return false;
  const int c = origin(previous(h)), d = origin(previous(back));
  if (is_fixed(c) && is_fixed(d)) return false;
  bool joined = false;
  const int seen_from = is_fixed(c) ? d : c, other = is_fixed(c) ? c : d;
  for_sides(seen_from, [&](const Side& side) { joined = joined || side.v == other; });
  return !joined;
}

/// Writes the triangle whose first half-edge this is.
void HalfEdges::put(int first, const std::array<int, 3>& corner, const std::array<int, 3>& twins) {
  for (int k = 0; k < 3; ++k) {
    corner_[at(first + k)] = corner[at(k)];
    twin_[at(first + k)] = twins[at(k)];
    if (twins[at(k)] >= 0) twin_[at(twins[at(k)])] = first + k;
  }
}

void HalfEdges::flip(int h) {
  const int g = twin(h);
  const int a = origin(h), b = target(h), c = origin(previous(h)), d = origin(previous(g));
  const int bc = twin(next(h)), ca = twin(previous(h)), ad = twin(next(g)), db = twin(previous(g));
  const int t = h - h % 3, s = g - g % 3;
  put(t, {a, d, c}, {ad, s + 2, ca});
  put(s, {d, b, c}, {db, bc, t + 1});
  set_out(a, t);
  set_out(d, t + 1);
  set_out(c, t + 2);
  set_out(b, s + 1);
}

int HalfEdges::split(int h) {
  const int m = n_vertices();
  out_.push_back(-1);
  fixed_.push_back(0);
  seen_.push_back(0);
  const int g = twin(h);
  const auto append = [this] {
    corner_.resize(corner_.size() + 3);
    twin_.resize(corner_.size());
    return static_cast<int>(corner_.size()) - 3;
  };
  const int a = origin(h), b = target(h), c = origin(previous(h));
  const int bc = twin(next(h)), ca = twin(previous(h));
  const int t = h - h % 3, beside_b = append();
  if (g < 0) {
    put(t, {a, m, c}, {-1, beside_b + 2, ca});
    put(beside_b, {m, b, c}, {-1, bc, t + 1});
  } else {
    const int d = origin(previous(g)), ad = twin(next(g)), db = twin(previous(g));
    const int s = g - g % 3, across = append();
    put(t, {a, m, c}, {s, beside_b + 2, ca});
    put(beside_b, {m, b, c}, {across, bc, t + 1});
    put(s, {m, a, d}, {t, ad, across + 1});
    put(across, {b, m, d}, {beside_b, s + 2, db});
    set_out(d, s + 2);
  }
  set_out(a, t);
  set_out(m, beside_b);
  set_out(b, beside_b + 1);
  set_out(c, t + 2);
  return m;
}

}  // namespace planar
