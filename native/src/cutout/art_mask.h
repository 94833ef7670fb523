// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutout/grid.h"
#include "planar/cutout.h"

namespace planar {

/// \throw std::invalid_argument
void require_image_size(const char* name, Eigen::Index height, Eigen::Index width);

/// \throw std::invalid_argument more vertices than are made
void require_vertices(double expected);

/// \throw std::invalid_argument
void require_options(const CutoutOptions& options);

/// The art of an image at the size that it is worked on.
struct ArtMask {
  Mask mask;            ///< without a border
  double sample;        ///< pixels a sample
  Eigen::Index pixels;  ///< of the image, that are art
  double side;          ///< in pixels: the longer one of the art
  double edge;          ///< in pixels: length of edges that the wish comes to
};

/// The length of edges with which so many vertices are spread evenly over an area.
double even_edge(double area, double vertices);

/// \throw std::invalid_argument no image, or no art in it
ArtMask art_mask(const AlphaImage& alpha, const CutoutOptions& options);

}  // namespace planar
