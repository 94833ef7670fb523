// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/plan.h"

#include <cmath>
#include <optional>

#include "cutout/contour.h"

namespace planar {
namespace {

/// Shorter rings than so many margins are noise: a single sample's is of more than six.
constexpr double least_ring = 3.0;
/// Edges may get so much longer than evenly spread vertices would have them, so that thin parts may have more
/// of these.
constexpr double longest_edge = 2.0;
/// Samples: shorter edges are steps of the samples.
constexpr double shortest_edge = 1.5;
/// The coarsest edge, of the longer side of what is meshed: with a longer one, whose margin is a fortieth of
/// that, limbs of a figure melt together.
constexpr double coarsest_of_side = 0.25;
/// The least that can be wished: no edge needs to be longer than it comes to.
constexpr double least_wish = 3.0;
/// Plans tried for an edge, and how near the estimate is to the wish then.
constexpr int tries = 6;
constexpr double near_estimate = 0.05;

/// Short enough for two rows of triangles across a line without thickness, which is twice the margin wide.
double shortest_of(const OutlineField& field, const CutoutOptions& options) {
  const double edge = options.edge ? field.edge : std::min(field.edge, field.margin / margin_of_edge);
  return std::max(shortest_edge, edge / options.finest);
}

double area_of(const OutlineField& field) {
  Eigen::Index inside = 0;
  for (const float d : field.distance.values()) inside += d > 0.0f ? 1 : 0;
  return static_cast<double>(inside) * field.sample * field.sample;
}

}  // namespace

std::vector<Points> rings_of(const OutlineField& field) {
  std::vector<Points> rings;
  for (const Points& contour : zero_contours(field.distance)) {
    if (perimeter(contour) > least_ring * field.margin) rings.push_back(even_ring(contour, ring_step));
  }
  return rings;
}

Plan::Plan(const ArtMask& art, const CutoutOptions& options)
    : field(outline_field(art, options, longest_edge)),
      rings(rings_of(field)),
      band(field),
      shortest(shortest_of(field, options)),
      longest(std::max(shortest, options.edge ? field.edge : longest_edge * field.edge)),
      sizes(field, rings, band, shortest, longest) {}

Planner::Planner(const AlphaImage& alpha, const CutoutOptions& options, std::function<void()> told)
    : alpha_(alpha), options_(options), told_(std::move(told)), art_(art_mask(alpha, options)) {
  const double margin = options.margin.value_or(0.0);
  const double square = std::sqrt(static_cast<double>(art_.pixels)) + 2.0 * margin;
  coarsest_ = std::max(coarsest_of_side * (art_.side + 2.0 * margin), even_edge(square * square, least_wish));
}

Plan Planner::plan(double edge) {
  told_();
  art_.edge = edge;
  return {art_, options_};
}

Plan Planner::of_wish() {
  Plan found = plan(art_.edge);
  // A margin of its own length may be most of what is meshed.
  if (options_.edge || !options_.margin) return found;
  const double edge = std::min(coarsest_, even_edge(area_of(found.field), options_.vertices));
  return edge > art_.edge ? plan(edge) : found;
}

Plan Planner::enough_for(double vertices, const Plan& finer) {
  double low = finer.field.edge * finer.field.sample, high = coarsest_;
  // Fine samples are for short edges: all coarser plans are made from the same ones, and so is the coarsest
  // for any wish.
  CutoutOptions coarse = options_;
  coarse.edge = coarsest_;
  art_ = art_mask(alpha_, coarse);
  Plan found = plan(high);
  double least = found.least(), most = finer.least();
  for (int i = 0; i < tries && least < (1.0 - near_estimate) * vertices && high > 1.001 * low; ++i) {
    // Counts are about powers of edges; halving in between where they are not.
    const double share = std::log(most / vertices) / std::log(most / least);
    const double edge = low * std::pow(high / low, i % 2 == 0 ? std::clamp(share, 0.1, 0.9) : 0.5);
    Plan next = plan(edge);
    if (next.least() > vertices) {
      low = edge;
      most = next.least();
    } else {
      high = edge;
      least = next.least();
      found = std::move(next);
    }
  }
  return found;
}

bool Planner::is_coarsest(const Plan& plan) const {
  return plan.field.edge * plan.field.sample >= 0.999 * coarsest_;
}

bool Planner::margin_holds(const Plan& plan) const {
  return options_.margin && plan.field.margin * plan.field.sample < margin_of_edge * coarsest_;
}

}  // namespace planar
