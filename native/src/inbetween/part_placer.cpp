// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/part_placer.h"

#include <cmath>
#include <numbers>

#include "base/complex_product.h"
#include "inbetween/edge_turns.h"

namespace planar {

using Complex = std::complex<double>;

namespace {

constexpr double straight = 1e-9;  // radians of an arc

Complex mean_of(const Spot& spot, const auto& place_of) {
  Complex sum = 0.0;
  double weights = 0.0;
  for (const auto& [v, weight] : spot) {
    sum += weight * place_of(v);
    weights += weight;
  }
  return sum / weights;
}

Complex place_in(const Points& x, int v) { return {x(v, 0), x(v, 1)}; }

}  // namespace

Ties::Ties(const Eigen::VectorXi& anchor_vertices, const Edges& joint_vertices) {
  for (const int v : anchor_vertices) anchor.push_back({v, 1.0});
  for (Eigen::Index i = 0; i < joint_vertices.rows(); ++i)
    joints.push_back({Spot{{joint_vertices(i, 0), 1.0}}, Spot{{joint_vertices(i, 1), 1.0}}});
}

PartPlacer::PartPlacer(const EdgeGraph& graph, const Points& from, const Points& to, const Ties& ties,
                       const Course& course)
    : graph_(graph), parts_(static_cast<std::size_t>(graph.n_parts)) {
  const auto add = [this](WeightedVertex held) {
    const int part = graph_.part[static_cast<std::size_t>(held.vertex)];
    if (part != -1) parts_[static_cast<std::size_t>(part)].anchor.push_back(held);
  };
  for (const WeightedVertex& held : ties.anchor) add(held);
  std::vector<char> held;
  for (const Part& part : parts_) held.push_back(!part.anchor.empty());
  for (int v = 0; v < graph.n_vertices; ++v) {
    const int part = graph.part[static_cast<std::size_t>(v)];
    if (part == -1) {
      isolated_.push_back(v);
      isolated_line_.push_back({place_in(from, v), place_in(to, v) - place_in(from, v)});
    } else if (!held[static_cast<std::size_t>(part)]) {
      add({v, 1.0});
    }
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    part.from = mean_of(part.anchor, [&from](int v) { return place_in(from, v); });
    part.to = mean_of(part.anchor, [&to](int v) { return place_in(to, v); });
    part.turn = course.turns[static_cast<Eigen::Index>(p)];
    part.arc = course.arc_turns[static_cast<Eigen::Index>(p)];
    if (std::abs(part.arc) < straight) part.arc = 0.0;
  }
  for (const std::array<Spot, 2>& joint : ties.joints) {
    Part& part = parts_[part_of(joint[1].front().vertex)];
    const auto offset = [&joint](const Points& x) {
      const auto place = [&x](int v) { return place_in(x, v); };
      return mean_of(joint[1], place) - mean_of(joint[0], place);
    };
    part.joint = joint;
    part.offset.from = offset(from);
    part.offset.way = offset(to) - part.offset.from;
  }
  std::vector<char> ordered(parts_.size());
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    // Up to one that is in order already, then back.
    std::vector<std::size_t> chain;
    for (std::size_t q = p; !ordered[q]; q = carrier_of(q)) {
      chain.push_back(q);
      ordered[q] = 1;
      if (!is_carried(q)) break;
    }
    order_.insert(order_.end(), chain.rbegin(), chain.rend());
  }
}

Complex PartPlacer::path(const Part& part, double u) {
  Complex way = u;
  if (part.arc != 0.0) {
    // (e^{iv·arc} - 1) / (e^{i·arc} - 1): the share of the way, turned so that it lies on the arc.
    const double half = part.arc / 2.0, gone = u * half + part.arc_change.at(u) / 2.0;
    way = std::polar(1.0, gone - half) * (std::sin(gone) / std::sin(half));
  }
  return part.from + way * (part.to - part.from) + part.path_change.at(u);
}

/// At u = 0 or 1, without path_change.
Complex PartPlacer::path_slope(const Part& part, double u) {
  if (part.arc == 0.0) return part.to - part.from;
  const double rate = part.arc + (u > 0.5 ? part.arc_change.last : part.arc_change.first);
  // d/dv (e^{iv·arc} - 1) / (e^{i·arc} - 1)
  const double half = part.arc / 2.0;
  // Not as the length of a polar form: LLVM makes no number of one that is negative.
  return rate / (2.0 * std::sin(half)) * std::polar(1.0, part.arc * u - half) * (part.to - part.from);
}

void PartPlacer::join(PartPlacer& before, PartPlacer& after, KeyGaps gaps) {
  for (std::size_t p = 0; p < before.parts_.size(); ++p) {
    Part &a = before.parts_[p], &b = after.parts_[p];
    meet_at_key(a.turn, b.turn, gaps, a.turn_change, b.turn_change);
    meet_at_key(a.arc, b.arc, gaps, a.arc_change, b.arc_change);
    if (a.anchor == b.anchor) {
      meet_at_key(path_slope(a, 1.0), path_slope(b, 0.0), gaps, a.path_change, b.path_change);
    }
    if (a.joint == b.joint) {
      meet_at_key(a.offset.way, b.offset.way, gaps, a.offset.change, b.offset.change);
    }
  }
  for (std::size_t i = 0; i < before.isolated_.size(); ++i) {
    Line &a = before.isolated_line_[i], &b = after.isolated_line_[i];
    meet_at_key(a.way, b.way, gaps, a.change, b.change);
  }
}

/// The translations that take parts at place_of(vertex) to their anchors, anchored(part number), and to their
/// joints' offsets, offset_of(part).
std::vector<Complex> PartPlacer::shifts(const auto& anchored, const auto& offset_of,
                                        const auto& place_of) const {
  std::vector<Complex> shift(parts_.size());
  for (const std::size_t p : order_) {
    const auto& [carrying, carried] = parts_[p].joint;
    if (!is_carried(p)) {
      shift[p] = anchored(p) - mean_of(parts_[p].anchor, place_of);
    } else {
      shift[p] = mean_of(carrying, place_of) + shift[carrier_of(p)] + offset_of(parts_[p]) -
                 mean_of(carried, place_of);
    }
  }
  return shift;
}

Points PartPlacer::place(const ComplexRows& points, Eigen::Index column, double u) const {
  std::vector<Complex> turn;
  for (const Part& part : parts_) {
    turn.push_back(std::polar(1.0, u * part.turn + part.turn_change.at(u)));
  }
  const auto turned = [&](int v) { return product(turn[part_of(v)], points(v, column)); };
  const std::vector<Complex> shift = shifts([&](std::size_t p) { return path(parts_[p], u); },
                                            [u](const Part& part) { return part.offset.at(u); }, turned);
  Points result(graph_.n_vertices, 2);
  for (int v = 0; v < graph_.n_vertices; ++v) {
    if (graph_.part[static_cast<std::size_t>(v)] == -1) continue;
    const Complex x = turned(v) + shift[part_of(v)];
    result.row(v) << x.real(), x.imag();
  }
  for (std::size_t i = 0; i < isolated_.size(); ++i) {
    const Complex x = isolated_line_[i].at(u);
    result.row(isolated_[i]) << x.real(), x.imag();
  }
  if (!result.allFinite()) throw SolveError("the in-betweens overflow: are the keys' numbers sensible?");
  return result;
}

void PartPlacer::hold_anchors(const Points& placed, Points& x) const {
  const auto before = [&placed](int v) { return place_in(placed, v); };
  const std::vector<Complex> shift = shifts(
      [&](std::size_t p) { return mean_of(parts_[p].anchor, before); },
      [&](const Part& part) { return mean_of(part.joint[1], before) - mean_of(part.joint[0], before); },
      [&x](int v) { return place_in(x, v); });
  for (int v = 0; v < graph_.n_vertices; ++v) {
    if (graph_.part[static_cast<std::size_t>(v)] == -1) continue;
    x.row(v) += Eigen::RowVector2d(shift[part_of(v)].real(), shift[part_of(v)].imag());
  }
}

Eigen::VectorXd PartPlacer::arcs(const Eigen::VectorXd& turns) {
  return turns.unaryExpr(
      [](double turn) { return std::abs(turn) < 1.5 * std::numbers::pi ? turn : wrapped(turn); });
}

}  // namespace planar
