// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planar/types.h"

namespace planar {

/// height×width numbers from 0 (transparent) to 1 (opaque), rows from the bottom.
using AlphaImage = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// height·width rows of red, green and blue, image rows from the bottom.
using Colours = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The most pixels that an image may have a side.
constexpr Eigen::Index most_pixels = 16384;

enum class Holes {
  keep,  ///< as holes of the mesh, where a triangle would fit in
  fill,
};

/// Lengths are in pixels of the image.
struct CutoutOptions {
  int vertices = 1500;           ///< wished, 3 to 2 million; what is given as `edge` counts instead
  std::optional<double> edge{};  ///< length where nothing asks for a shorter one, above 0

  /// How far the outline stays away from the art, from 0. Without: a tenth of Outline::edge. Never less than
  /// two samples of the image as it is worked on (see Outline::sample), which keep every pixel inside.
  std::optional<double> margin{};

  /// Gaps and notches narrower than twice this are filled, from 0. Without: the margin.
  std::optional<double> rounding{};

  double threshold = 0.05;  ///< pixels of a larger alpha are art; from 0, below 1
  Holes holes = Holes::keep;

  /// Islands of a smaller share of the art are dropped, from 0, below 1. Without: 3e-4, or what a quarter of
  /// a squared edge covers if that is less.
  std::optional<double> smallest{};

  /// Edges are shortened to 1/finest of their length at most, from 1 to 100. With a wish and a margin that is
  /// less than a tenth of them, further, to 10/finest margins: two rows of triangles then fit across a hair.
  double finest = 6.0;

  /// Called with the share of the work done, in the caller's thread; false stops by `Cancelled`.
  std::function<bool(double)> progress{};
};

/// Closed polylines round the art of an image, in pixels from its lower left corner.
struct Outline {
  /// Each n×2, without its first point again at its end; the art is on the left: around it counter-clockwise,
  /// around holes clockwise. They do not touch each other or themselves.
  std::vector<Points> rings;

  /// Length of edges that the wish comes to, before thin parts ask for shorter ones: in the area of the art,
  /// or in the outline's where a margin is given. Of a Cutout longer where thin parts would need more than
  /// the wish.
  double edge;
  double margin;    ///< as used
  double rounding;  ///< as used
  double sample;    ///< pixels a sample of the image as it is worked on: 2 for half its size

  int islands;                  ///< kept, as the outline joins them
  int holes;                    ///< kept
  int dropped_islands;          ///< smaller than `smallest`
  Eigen::Index dropped_pixels;  ///< of the image, as far as samples tell
  int filled_holes;
};

/// The outline of an image's art.
///
/// Where no margin is given that of cutout() is wider if thin parts would need more vertices than are wished.
///
/// The image is worked on at 512 to 1024 samples a side, or with its margin at twice that at most (at more
/// where the wish for vertices needs it), by block maxima, so that no art is lost. Art is grown by margin +
/// rounding and taken back by the rounding, with exact distances [Felzenszwalb12], smoothed (Gaussian, σ of
/// one sample) and contoured at zero by marching squares; points are three quarters of a sample apart.
///
/// \throw std::invalid_argument an empty or too large image, numbers outside of 0 to 1, no art, options out
/// of range
///
/// \throw Cancelled options.progress returned false
Outline outline(const AlphaImage& alpha, const CutoutOptions& options = {});

/// A drawing as a mesh.
struct Cutout {
  Points points;          ///< n×2 in pixels from the lower left corner of the image; those of rings first
  Triangles triangles;    ///< m×3, counter-clockwise
  Eigen::VectorXi parts;  ///< n: the island of each point, numbered in order of the points
  int n_parts;
  std::vector<Eigen::VectorXi> rings;  ///< the boundary's vertices, as the rings of Outline go round

  Outline outline;  ///< what it was made from
  double edge;      ///< length of edges where nothing asks for shorter ones, as used
  double shortest;  ///< length below which they are not made shorter, as used

  /// Whether there are as many vertices as wished, within a quarter; true if an edge was given.
  bool reached;

  /// What a person who made the wish should know, a sentence each: how many vertices the drawing needs at
  /// least, with the options as they are but for the wish, that islands were dropped. Empty if there is
  /// nothing.
  std::vector<std::string> said;
};

/// An even mesh of an image's art, ready to be posed: every pixel of it inside, two rows of triangles across
/// thin parts, no slivers.
///
/// The outline becomes a polygon that stays in a band along it, with edges as long as this allows. Edges are
/// shorter where the art is thin (1.1 times the distance to the outline, on its medial axis) and grow by 0.35
/// of the distance from there. Where they would need more vertices than are wished by over a quarter,
/// Outline::edge is lengthened, and with it the margin where none is given, and the shortest edge: up to a
/// quarter of the longer side of the art with its margin, or what a wish for 3 vertices comes to in a square
/// of as much art. That is the least a drawing needs, the same for any wish. Inside lie hexagonal lattices
/// from coarse to fine, joined by constrained Delaunay triangulation and smoothed towards centroids weighted
/// by area over squared size [Chen04].
///
/// \throw as outline()
/// \throw SolveError the outline could not be triangulated
Cutout cutout(const AlphaImage& alpha, const CutoutOptions& options = {});

/// The alpha of an opaque image whose border is plain.
struct Keyed {
  AlphaImage alpha;             ///< 0 where the border's colour reaches from the border, else 1
  bool keyed;                   ///< false: alpha is 1 everywhere
  std::array<float, 3> colour;  ///< of the border: the median of its pixels
  std::string said;             ///< why nothing was keyed; empty if it was
};

/// Floods the border's colour from the border inwards, over pixels within `tolerance` of it in each channel.
/// It must be the colour of four fifths of the border's pixels.
///
/// \param colours height·width rows, in any range
///
/// \throw std::invalid_argument sizes that do not match, an empty or too large image, not finite
Keyed key_colour(const Colours& colours, Eigen::Index height, Eigen::Index width,
                 double tolerance = 24.0 / 255.0);

}  // namespace planar
