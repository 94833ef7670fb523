// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "cutout/art_mask.h"
#include "cutout/outline_field.h"
#include "cutout/size_field.h"

namespace planar {

/// Contours of a field made even, in samples.
std::vector<Points> rings_of(const OutlineField& field);

/// Outline and sizes from which a mesh is made. Lengths are in samples.
struct Plan {
  OutlineField field;
  std::vector<Points> rings;
  Band band;
  double shortest, longest;  ///< sizes are between these
  SizeField sizes;

  /// \param art its edge is that of the plan
  Plan(const ArtMask& art, const CutoutOptions& options);

  /// About how many vertices a mesh has at least.
  double least() const { return sizes.vertices_for(longest); }
};

/// Plans for fewer and fewer vertices, by longer edges with their margins.
class Planner {
 public:
  /// \param told is called before each plan
  Planner(const AlphaImage& alpha, const CutoutOptions& options, std::function<void()> told);

  /// The one of the edge that the wish comes to in the area that is meshed.
  Plan of_wish();

  /// One that about so many vertices are enough for, with the shortest edge for which this holds; the
  /// coarsest if it does not for any.
  ///
  /// \param finer a plan that needs more
  Plan enough_for(double vertices, const Plan& finer);

  /// Whether no plan is coarser.
  bool is_coarsest(const Plan& plan) const;

  /// Whether edges could be longer with a larger margin than the one that was given.
  bool margin_holds(const Plan& plan) const;

 private:
  Plan plan(double edge);

  const AlphaImage& alpha_;
  const CutoutOptions& options_;
  std::function<void()> told_;
  ArtMask art_;
  double coarsest_;  ///< edge, in pixels
};

}  // namespace planar
