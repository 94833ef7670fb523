// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/checks.h"
#include "cutout/art_mask.h"
#include "cutout/regions.h"
#include "planar/cutout.h"

namespace planar {
namespace {

/// Less is a picture that ends at its border, as a photograph does.
constexpr double plain_share = 0.8;

/// Rows of `colours` along the border, each once.
std::vector<Eigen::Index> border_of(Eigen::Index height, Eigen::Index width) {
  std::vector<Eigen::Index> border;
  for (Eigen::Index y = 0; y < height; ++y) {
    const Eigen::Index step = y == 0 || y + 1 == height ? 1 : std::max<Eigen::Index>(width - 1, 1);
    for (Eigen::Index x = 0; x < width; x += step) border.push_back(y * width + x);
  }
  return border;
}

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Keyed key_colour(const Colours& colours, Eigen::Index height, Eigen::Index width, double tolerance) {
  require_image_size("colours", height, width);
  require_rows("colours", colours.rows(), height * width, "pixel");
  if (!(tolerance >= 0.0)) throw std::invalid_argument("tolerance: must be a number from 0");
  for (Eigen::Index i = 0; i < colours.rows(); ++i) {
    if (!colours.row(i).allFinite())
      throw std::invalid_argument(row_of("colours", i) + "not a finite number");
  }

  const std::vector<Eigen::Index> border = border_of(height, width);
  Keyed result{AlphaImage::Ones(height, width), false, {}, {}};
  Eigen::RowVector3f key;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> values;
    values.reserve(border.size());
    for (const Eigen::Index i : border) values.push_back(colours(i, c));
    key[c] = result.colour[at(c)] = median(std::move(values));
  }
  const auto limit = static_cast<float>(tolerance);
  const auto near = [&](Eigen::Index i) { return (colours.row(i) - key).cwiseAbs().maxCoeff() <= limit; };
  const auto plain = std::count_if(border.begin(), border.end(), near);
  if (static_cast<double>(plain) < plain_share * static_cast<double>(border.size())) {
    result.said = "The border of the image is not plain: " +
                  std::to_string(100 * plain / static_cast<std::ptrdiff_t>(border.size())) +
                  " % of it are of one colour, 80 % are needed.";
    return result;
  }

  Mask back(static_cast<int>(width), static_cast<int>(height), 0);
  for (Eigen::Index i = 0; i < colours.rows(); ++i) back.values()[at(i)] = static_cast<std::uint8_t>(near(i));
  const Regions regions = regions_of(back);
  std::vector<char> flooded(at(regions.count), 0);
  for (const Eigen::Index i : border) {
    if (const int region = regions.region.values()[at(i)]; region >= 0) flooded[at(region)] = 1;
  }
  bool any_left = false;
  for (Eigen::Index i = 0; i < colours.rows(); ++i) {
    const int region = regions.region.values()[at(i)];
    const bool clear = region >= 0 && flooded[at(region)] != 0;
    if (clear) result.alpha.data()[i] = 0.0f;
    any_left = any_left || !clear;
  }
  if (!any_left) {
    result.alpha.setOnes();
    result.said = "All of the image has the colour of its border.";
    return result;
  }
  result.keyed = true;
  return result;
}

}  // namespace planar
