// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/outline_field.h"

#include <array>
#include <cmath>

#include "cutout/distance_transform.h"
#include "cutout/regions.h"

namespace planar {
namespace {

/// Samples; what smoothing and chords take of it keeps every sample of the art inside.
constexpr double least_margin = 2.0;
/// Of the art, and of the square of an edge: islands below both are specks.
constexpr double speck_share = 3e-4, speck_of_edge = 0.25;
/// Distances are smoothed so far from the outline.
constexpr double smoothed_within = 4.0;

Mask bordered(const Mask& mask, int border) {
  Mask result(mask.width() + 2 * border, mask.height() + 2 * border, 0);
  for (int y = 0; y < mask.height(); ++y) {
    std::copy_n(mask.row(y), mask.width(), result.row(y + border) + border);
  }
  return result;
}

Mask inverted(Mask mask) {
  for (std::uint8_t& value : mask.values()) value = static_cast<std::uint8_t>(value == 0);
  return mask;
}

std::vector<Eigen::Index> areas_of(const Regions& regions, const Mask* counted) {
  std::vector<Eigen::Index> area(at(regions.count), 0);
  for (std::size_t i = 0; i < regions.region.size(); ++i) {
    const std::int32_t region = regions.region.values()[i];
    if (region >= 0 && (counted == nullptr || counted->values()[i] != 0)) ++area[at(region)];
  }
  return area;
}

Mask where_below(const Grid<float>& values, double limit) {
  Mask result(values.width(), values.height(), 0);
  const auto most = static_cast<float>(limit);
  for (std::size_t i = 0; i < values.size(); ++i) {
    result.values()[i] = static_cast<std::uint8_t>(values.values()[i] <= most);
  }
  return result;
}

/// Takes islands of too little art out of it. The largest always stays.
void drop_specks(const CutoutOptions& options, const Mask& grown, Mask& art, OutlineField& field) {
  const Regions islands = regions_of(grown);
  if (islands.count < 2) return;
  const std::vector<Eigen::Index> area = areas_of(islands, &art);
  double all = 0.0;
  for (const Eigen::Index a : area) all += static_cast<double>(a);
  const double least = options.smallest
                           ? *options.smallest * all
                           : std::min(speck_share * all, speck_of_edge * field.edge * field.edge);
  const auto largest = std::max_element(area.begin(), area.end()) - area.begin();
  for (std::size_t i = 0; i < area.size(); ++i) {
    if (static_cast<double>(area[i]) >= least || i == static_cast<std::size_t>(largest)) continue;
    ++field.dropped_islands;
    field.dropped_samples += area[i];
  }
  if (field.dropped_islands == 0) return;
  for (std::size_t i = 0; i < art.size(); ++i) {
    const std::int32_t island = islands.region.values()[i];
    if (island < 0 || island == largest) continue;
    if (static_cast<double>(area[at(island)]) < least) art.values()[i] = 0;
  }
}

/// Fills all holes, or those that no triangle would fit in.
void fill_holes(const CutoutOptions& options, Mask& grown, OutlineField& field) {
  const Regions regions = regions_of(inverted(grown));  // 0 is the border, which begins at the first sample
  if (regions.count < 2) return;
  const std::vector<Eigen::Index> area = areas_of(regions, nullptr);
  const auto filled = [&](std::int32_t region) {
    return region > 0 &&
           (options.holes == Holes::fill || static_cast<double>(area[at(region)]) < field.edge * field.edge);
  };
  for (int region = 1; region < regions.count; ++region) field.filled_holes += filled(region) ? 1 : 0;
  for (std::size_t i = 0; i < grown.size(); ++i) {
    if (filled(regions.region.values()[i])) grown.values()[i] = 1;
  }
}

/// A Gaussian of one sample, where the outline is near.
void smooth(Grid<float>& distance) {
  constexpr int radius = 3;
  std::array<float, 2 * radius + 1> weight{};
  float sum = 0.0f;
  for (int k = -radius; k <= radius; ++k) {
    sum += weight[at(k + radius)] = std::exp(-0.5f * static_cast<float>(k * k));
  }
  for (float& w : weight) w /= sum;

  const Grid<float> before = distance;
  for (int y = radius; y + radius < distance.height(); ++y) {
    for (int x = radius; x + radius < distance.width(); ++x) {
      if (std::abs(before(x, y)) >= static_cast<float>(smoothed_within)) continue;
      float mean = 0.0f;
      for (int j = -radius; j <= radius; ++j) {
        const float* row = before.row(y + j) + x;
        float line = 0.0f;
        for (int i = -radius; i <= radius; ++i) line += weight[at(i + radius)] * row[i];
        mean += weight[at(j + radius)] * line;
      }
      distance(x, y) = mean;
    }
  }
}

}  // namespace

OutlineField outline_field(const ArtMask& art, const CutoutOptions& options, double reach) {
  OutlineField field{};
  field.sample = art.sample;
  field.edge = art.edge / art.sample;
  field.margin =
      std::max(least_margin, options.margin ? *options.margin / art.sample : margin_of_edge * field.edge);
  field.rounding = options.rounding ? *options.rounding / art.sample : field.margin;
  // Half a sample more, as a sample outside is anywhere in the next one's width: the outline is then at the
  // margin to half a sample, wherever it lies between samples.
  const double growth = field.margin + field.rounding + 0.5;
  field.border = static_cast<int>(std::ceil(growth)) + 4;

  Mask inside = bordered(art.mask, field.border);
  Grid<float> from_art = distance_to(inside, growth + 2.0 * smoothed_within);
  Mask grown = where_below(from_art, growth);
  drop_specks(options, grown, inside, field);
  if (field.dropped_islands > 0) {
    from_art = distance_to(inside, growth + 2.0 * smoothed_within);
    grown = where_below(from_art, growth);
  }
  fill_holes(options, grown, field);

  NearestSites from_outside = nearest_sites(
      inverted(grown), field.rounding + std::max(2.0 * smoothed_within, 1.0 + reach * field.edge));

  // Distances are between centres of samples: half a sample lies between the outermost one of a mask and its
  // border.
  field.distance = std::move(from_outside.distance);
  field.foot = std::move(from_outside.site);
  const auto back = static_cast<float>(field.rounding + 0.5), out = static_cast<float>(field.margin + 0.5);
  for (std::size_t i = 0; i < grown.size(); ++i) {
    float& d = field.distance.values()[i];
    d = grown.values()[i] != 0 ? d - back : out - from_art.values()[i];
  }
  smooth(field.distance);
  return field;
}

}  // namespace planar
