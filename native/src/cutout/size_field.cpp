// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/size_field.h"

#include <cmath>

namespace planar {
namespace {

/// What smoothing, sampling and the straight lines between samples may take of the margin.
constexpr double unsure = 1.1, least_band = 0.25;
/// Of the distance from the medial axis to the outline: a vertex lies between, in two rows of triangles.
constexpr double size_of_thickness = 1.1;
/// How far apart feet are for that, in distances: 2 in a strip, 1.4 in a right angle, which is no thin part,
/// and in samples.
constexpr double steps_across = 1.7, least_across = 2.5;
/// Thinner than this share of the margin is no art, but where islands just merge. Such necks get edges as
/// short as they need: with fewer their triangles are slivers.
constexpr double neck = 0.75, shortest_neck = 2.0 * ring_step;
/// Growth of the size per distance: 0.2 has a third more vertices, 0.6 angles of 10 degrees.
constexpr float grading = 0.35f;
/// Lengths of chords that are tried, from the shortest size to the longest.
constexpr int chord_bins = 12;
constexpr int size_bins = 256;
/// Vertices beside those of evenly graded triangles, measured on drawings.
constexpr double uneven = 1.06;

/// Sizes on the medial axis: where feet of neighbours are far apart.
void limit_by_thickness(const OutlineField& field, double shortest, double longest, Grid<float>& size) {
  const Grid<float>& d = field.distance;
  const int w = d.width();
  const double beyond = field.rounding + 0.5;  // feet are so much further than the outline
  const auto meet = [&](std::size_t a, std::size_t b) {
    const std::int32_t p = field.foot.values()[a], q = field.foot.values()[b];
    if (p < 0 || q < 0 || p == q) return;
    const float near = d.values()[a], other = d.values()[b];
    if (near <= 0.0f || other <= 0.0f) return;
    const double gap = std::hypot(p % w - q % w, p / w - q / w);
    if (gap <= least_across || gap <= steps_across * (static_cast<double>(std::max(near, other)) + beyond))
      return;
    for (const std::size_t i : {a, b}) {
      const auto thickness = static_cast<double>(d.values()[i]);
      const double least = thickness < neck * field.margin ? std::min(shortest_neck, shortest) : shortest;
      const double wish = std::clamp(size_of_thickness * thickness, least, longest);
      size.values()[i] = std::min(size.values()[i], static_cast<float>(wish));
    }
  };
  for (int y = 0; y + 1 < d.height(); ++y) {
    for (int x = 0; x + 1 < w; ++x) {
      const std::size_t i = d.index(x, y);
      if (field.foot.values()[i] < 0) continue;
      meet(i, i + 1);
      meet(i, i + at(w));
    }
  }
}

/// The longest chord round each point of a ring that stays in the band.
void limit_by_chords(const Points& ring, const Band& band, double shortest, double longest,
                     Grid<float>& size) {
  const auto n = static_cast<int>(ring.rows());
  std::vector<double> limit(at(n), shortest);
  std::vector<char> fits(at(n), 1);
  const double ratio = std::pow(longest / shortest, 1.0 / (chord_bins - 1));
  double chord = shortest;
  for (int k = 0; k < chord_bins; ++k, chord *= ratio) {
    const int half = std::max(1, static_cast<int>(std::lround(0.5 * chord / ring_step)));
    if (2 * half >= n / 2) break;
    for (int i = 0; i < n; ++i) {
      if (fits[at(i)] == 0) continue;
      const Eigen::RowVector2d a = ring.row((i + n - half) % n), b = ring.row((i + half) % n);
      const Eigen::RowVector2d to = b - a, off = ring.row(i) - 0.5 * (a + b);
      const bool outside = to[0] * off[1] - to[1] * off[0] > 0.0;  // the chord is; the art lies on the left
      if (off.norm() > (outside ? band.outward : band.inward)) {
        fits[at(i)] = 0;
      } else {
        limit[at(i)] = k + 1 == chord_bins ? longest : chord;
      }
    }
  }
  for (int i = 0; i < n; ++i) {
    const int x = std::clamp(static_cast<int>(std::lround(ring(i, 0))), 0, size.width() - 1);
    const int y = std::clamp(static_cast<int>(std::lround(ring(i, 1))), 0, size.height() - 1);
    size(x, y) = std::min(size(x, y), static_cast<float>(limit[at(i)]));
  }
}

/// The lower envelope of cones over all sizes, with distances along sides and diagonals of samples, in two
/// sweeps.
void grade(Grid<float>& size) {
  const int w = size.width(), h = size.height();
  constexpr float side = grading, diagonal = grading * 1.41421356f;
  for (int y = 0; y < h; ++y) {
    float* row = size.row(y);
    if (y > 0) {
      const float* below = size.row(y - 1);
      row[0] = std::min({row[0], below[0] + side, below[1] + diagonal});
      for (int x = 1; x + 1 < w; ++x) {
        row[x] = std::min({row[x], below[x] + side, below[x - 1] + diagonal, below[x + 1] + diagonal});
      }
      row[w - 1] = std::min({row[w - 1], below[w - 1] + side, below[w - 2] + diagonal});
    }
    for (int x = 1; x < w; ++x) row[x] = std::min(row[x], row[x - 1] + side);
  }
  for (int y = h - 1; y >= 0; --y) {
    float* row = size.row(y);
    if (y + 1 < h) {
      const float* above = size.row(y + 1);
      row[0] = std::min({row[0], above[0] + side, above[1] + diagonal});
      for (int x = 1; x + 1 < w; ++x) {
        row[x] = std::min({row[x], above[x] + side, above[x - 1] + diagonal, above[x + 1] + diagonal});
      }
      row[w - 1] = std::min({row[w - 1], above[w - 1] + side, above[w - 2] + diagonal});
    }
    for (int x = w - 2; x >= 0; --x) row[x] = std::min(row[x], row[x + 1] + side);
  }
}

}  // namespace

Band::Band(const OutlineField& field)
    : inward(std::max(least_band, field.margin - unsure)),
      outward(std::max(least_band, std::min(inward, field.rounding))) {}

bool Band::holds(const Grid<float>& distance, const Eigen::RowVector2d& a,
                 const Eigen::RowVector2d& b) const {
  const int steps = std::max(8, static_cast<int>((b - a).norm()));
  for (int k = 1; k < steps; ++k) {
    const Eigen::RowVector2d p = a + (b - a) * (static_cast<double>(k) / steps);
    const double d = sample(distance, p[0], p[1]);
    if (d > inward || d < -outward) return false;
  }
  return true;
}

SizeField::SizeField(const OutlineField& field, const std::vector<Points>& rings, const Band& band,
                     double shortest, double longest)
    : size(field.distance.width(), field.distance.height(), static_cast<float>(longest)),
      shortest_(shortest),
      longest_(longest) {
  limit_by_thickness(field, shortest, longest, size);
  for (const Points& ring : rings) limit_by_chords(ring, band, shortest, longest, size);
  grade(size);

  const double ratio = std::log(longest / shortest) / size_bins;
  for (int i = 0; i < size_bins; ++i) bins_.push_back({shortest * std::exp((i + 0.5) * ratio), 0.0, 0.0});
  const auto bin = [&](double value) -> Bin& {
    const double place = ratio > 0.0 ? std::log(value / shortest) / ratio : 0.0;
    return bins_[at(std::clamp(static_cast<int>(place), 0, size_bins - 1))];
  };
  for (int y = 0; y < size.height(); ++y) {
    for (int x = 0; x < size.width(); ++x) {
      if (field.distance(x, y) > 0.0f) bin(static_cast<double>(size(x, y))).area += 1.0;
    }
  }
  for (const Points& ring : rings) {
    for (Eigen::Index i = 0; i < ring.rows(); ++i)
      bin(sample(size, ring(i, 0), ring(i, 1))).length += ring_step;
  }
}

double SizeField::vertices_for(double edge) const {
  // Equilateral triangles, two a vertex, and half a vertex more for each on the boundary; uneven where sizes
  // meet.
  double vertices = 0.0;
  for (const Bin& bin : bins_) {
    const double s = std::min(bin.size, edge);
    vertices += uneven * 2.0 / std::sqrt(3.0) * bin.area / (s * s) + 0.5 * bin.length / s;
  }
  return vertices;
}

double SizeField::edge_for(double vertices) const {
  double low = shortest_, high = longest_;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    (vertices_for(middle) > vertices ? low : high) = middle;
  }
  return high;
}

void SizeField::limit(double edge) {
  const auto most = static_cast<float>(edge);
  for (float& s : size.values()) s = std::min(s, most);
}

}  // namespace planar
