// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutout/art_mask.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "base/checks.h"

namespace planar {
namespace {

/// Of these a minute and a gigabyte are needed.
constexpr int most_vertices = 2'000'000;
/// The longest side in samples. Below, details of the outline are lost in its smoothing; above, only time.
constexpr Eigen::Index least_samples = 512, most_samples = 1024;
/// Where many vertices are wished, an edge has so many samples, up to so large an image: with fewer the sizes
/// of triangles are too coarse steps.
constexpr double samples_an_edge = 5.0;
constexpr Eigen::Index most_samples_for_edges = 4096;
/// A square of evenly spread vertices has their root along its side; twice that is for art that fills a
/// quarter of the image. More is for dots, which their margin joins.
constexpr double edges_across = 2.0;

[[noreturn]] void refuse(const char* name, double value, const char* wanted) {
  throw std::invalid_argument(std::string(name) + ": " + std::to_string(value) + ", expected " + wanted);
}

/// Pixels a side of a sample, or samples a side of a pixel.
struct Scale {
  Eigen::Index shrink = 1, enlarge = 1;
};

Scale working_scale(Eigen::Index longest, double edge, double vertices) {
  Scale scale;
  if (longest > most_samples) scale.shrink = (longest + most_samples - 1) / most_samples;
  if (longest < least_samples) scale.enlarge = (least_samples + longest - 1) / longest;
  const auto fine = [&] {
    return edge * static_cast<double>(scale.enlarge) >= samples_an_edge * static_cast<double>(scale.shrink);
  };
  const double across = samples_an_edge * edges_across * std::sqrt(vertices);
  const auto most = static_cast<Eigen::Index>(std::min(static_cast<double>(most_samples_for_edges), across));
  while (!fine() && scale.shrink > 1 && longest <= most * (scale.shrink - 1)) --scale.shrink;
  while (!fine() && scale.shrink == 1 && longest * (scale.enlarge + 1) <= most) ++scale.enlarge;
  return scale;
}

Mask shrunk(const AlphaImage& alpha, float threshold, Eigen::Index factor) {
  const auto size = [factor](Eigen::Index n) { return static_cast<int>((n + factor - 1) / factor); };
  Mask mask(size(alpha.cols()), size(alpha.rows()), 0);
  for (Eigen::Index y = 0; y < alpha.rows(); ++y) {
    std::uint8_t* out = mask.row(static_cast<int>(y / factor));
    const float* in = alpha.data() + y * alpha.cols();
    for (Eigen::Index first = 0; first < alpha.cols(); first += factor, ++out) {
      const Eigen::Index end = std::min(first + factor, alpha.cols());
      for (Eigen::Index x = first; x < end; ++x) *out |= static_cast<std::uint8_t>(in[x] > threshold);
    }
  }
  return mask;
}

Mask enlarged(const AlphaImage& alpha, float threshold, Eigen::Index factor) {
  Mask mask(static_cast<int>(alpha.cols() * factor), static_cast<int>(alpha.rows() * factor), 0);
  for (int y = 0; y < mask.height(); ++y) {
    const float* in = alpha.data() + y / factor * alpha.cols();
    std::uint8_t* out = mask.row(y);
    for (Eigen::Index x = 0; x < alpha.cols(); ++x, out += factor) {
      std::fill_n(out, factor, static_cast<std::uint8_t>(in[x] > threshold));
    }
  }
  return mask;
}

}  // namespace

void require_image_size(const char* name, Eigen::Index height, Eigen::Index width) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (height <= 0 || width <= 0) throw std::invalid_argument(std::string(name) + ": an image of " + size);
  if (height > most_pixels || width > most_pixels) {
    throw std::invalid_argument(std::string(name) + ": an image of " + size + "; at most " +
                                std::to_string(most_pixels) + " a side are possible: make it smaller");
  }
}

void require_vertices(double expected) {
  if (expected <= most_vertices) return;
  throw std::invalid_argument("edge: its mesh would have some " +
                              std::to_string(std::llround(std::min(expected, 1e18))) + " vertices, at most " +
                              std::to_string(most_vertices) + " are made");
}

void require_options(const CutoutOptions& o) {
  // Written so that what is no number is refused, too.
  if (o.vertices < 3 || o.vertices > most_vertices) {
    throw std::invalid_argument("vertices: " + std::to_string(o.vertices) + ", expected 3 to " +
                                std::to_string(most_vertices));
  }
  const auto length = [](const char* name, const std::optional<double>& value) {
    if (value && !(*value >= 0.0 && *value <= most_pixels)) refuse(name, *value, "0 to 16384 pixels");
  };
  if (o.edge && !(*o.edge > 0.0 && std::isfinite(*o.edge)))
    refuse("edge", *o.edge, "a finite length above 0");
  length("margin", o.margin);
  length("rounding", o.rounding);
  if (!(o.threshold >= 0.0 && o.threshold < 1.0)) refuse("threshold", o.threshold, "0 or more, below 1");
  if (o.smallest && !(*o.smallest >= 0.0 && *o.smallest < 1.0)) {
    refuse("smallest", *o.smallest, "a share of 0 or more, below 1");
  }
  if (!(o.finest >= 1.0 && o.finest <= 100.0)) refuse("finest", o.finest, "1 to 100");
}

double even_edge(double area, double vertices) {
  // Of equilateral triangles there are two a vertex.
  return std::sqrt(2.0 / std::sqrt(3.0) * area / vertices);
}

ArtMask art_mask(const AlphaImage& alpha, const CutoutOptions& options) {
  require_image_size("alpha", alpha.rows(), alpha.cols());
  const auto threshold = static_cast<float>(options.threshold);
  ArtMask result{};
  Eigen::Index left = alpha.cols(), right = -1, bottom = -1, top = -1;
  for (Eigen::Index y = 0; y < alpha.rows(); ++y) {
    const float* row = alpha.data() + y * alpha.cols();
    int art = 0, wrong = 0;
    for (Eigen::Index x = 0; x < alpha.cols(); ++x) {
      art += static_cast<int>(row[x] > threshold);
      wrong += static_cast<int>(!(row[x] >= 0.0f && row[x] <= 1.0f));
    }
    if (wrong > 0) throw std::invalid_argument(row_of("alpha", y) + "not a number from 0 to 1");
    result.pixels += art;
    if (art == 0) continue;
    if (bottom < 0) bottom = y;
    top = y;
    Eigen::Index x = 0;
    while (x < left && !(row[x] > threshold)) ++x;
    left = x;
    x = alpha.cols() - 1;
    while (x > right && !(row[x] > threshold)) --x;
    right = x;
  }
  if (result.pixels == 0) {
    throw std::invalid_argument(
        "alpha: all of the image is transparent: no pixel is above the threshold of " +
        std::to_string(options.threshold));
  }
  result.side = static_cast<double>(std::max(right - left, top - bottom) + 1);
  const auto pixels = static_cast<double>(result.pixels);
  result.edge = options.edge.value_or(even_edge(pixels, options.vertices));
  const double one = even_edge(pixels, 1.0) / result.edge;
  const double vertices = one * one;
  require_vertices(vertices);
  // A margin wider than half of the image needs no samples as fine as that.
  const double around = 2.0 * std::max(options.margin.value_or(0.0), options.rounding.value_or(0.0));
  const Eigen::Index size = std::max(alpha.rows(), alpha.cols());
  const Eigen::Index longest = std::max(size, (size + static_cast<Eigen::Index>(around)) / 2);
  const Scale scale = working_scale(longest, result.edge, vertices);
  result.sample = static_cast<double>(scale.shrink) / static_cast<double>(scale.enlarge);
  result.mask =
      scale.enlarge > 1 ? enlarged(alpha, threshold, scale.enlarge) : shrunk(alpha, threshold, scale.shrink);
  return result;
}

}  // namespace planar
