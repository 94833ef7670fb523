// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/held_samples.h"

#include <cmath>

#include "base/index.h"

namespace planar {

void HeldSamples::add(const HeldShape::Triangle& triangle, int number, double area) {
  sum_.clear(2);
  for (int c = 0; c < 3; ++c) sum_.add(triangle.vertex[at(c)], triangle.gradient(c));
  for (int i = 0; i < sum_.size(); ++i) {
    point_.push_back(sum_.points()[at(i)]);
    gradient_.push_back({sum_.value(i, 0), sum_.value(i, 1)});
  }
  start_.push_back(static_cast<std::ptrdiff_t>(point_.size()));
  area_.push_back(area);
  triangle_.push_back(number);
}

void HeldSamples::shorten(std::size_t size) {
  start_.resize(size + 1);
  point_.resize(static_cast<std::size_t>(start_.back()));
  gradient_.resize(point_.size());
  area_.resize(size);
  triangle_.resize(size);
}

Jacobian HeldSamples::jacobian(std::size_t i, const Points& d) const {
  double xx = 1.0, xy = 0.0, yx = 0.0, yy = 1.0;
  for (std::ptrdiff_t e = start_[i]; e < start_[i + 1]; ++e) {
    const double* p = d.data() + 2 * static_cast<std::ptrdiff_t>(point_[at(e)]);
    const auto [gx, gy] = gradient_[at(e)];
    xx += p[0] * gx;
    xy += p[0] * gy;
    yx += p[1] * gx;
    yy += p[1] * gy;
  }
  return {{xx, xy, yx, yy}};
}

double HeldSamples::value(const Points& d, Points* gradient) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    const Jacobian j = jacobian(i, d);
    sum += area_[i] * j.value();
    if (!std::isfinite(sum)) return sum;
    if (gradient == nullptr) continue;
    const std::array<double, 4> slope = j.slope();
    for (std::ptrdiff_t e = start_[i]; e < start_[i + 1]; ++e) {
      double* r = gradient->data() + 2 * static_cast<std::ptrdiff_t>(point_[at(e)]);
      const auto [gx, gy] = gradient_[at(e)];
      r[0] += area_[i] * (slope[0] * gx + slope[1] * gy);
      r[1] += area_[i] * (slope[2] * gx + slope[3] * gy);
    }
  }
  return sum;
}

}  // namespace planar
