// SPDX-License-Identifier: GPL-3.0-or-later
#include "planar/cutout.h"

#include <cmath>

#include "cutout/art_mask.h"
#include "cutout/boundary.h"
#include "cutout/contour.h"
#include "cutout/delaunay.h"
#include "cutout/interior.h"
#include "cutout/outline_field.h"
#include "cutout/plan.h"
#include "cutout/size_field.h"
#include "cutout/smoothing.h"
#include "mesh/mesh.h"

namespace planar {
namespace {

/// Rounds in which gaps are filled; there are few left after the first.
constexpr int gap_rounds = 3;
/// Rounds of smoothing: with none the smallest angle is 13 degrees, with 4 it is 20.
constexpr int smoothings = 4;
constexpr int widenings = 3;
constexpr int triangulations = 1 + gap_rounds + smoothings + widenings;  // at most
/// Of the wish.
constexpr double near_wish = 0.25, near_wish_at_once = 0.1;
constexpr int attempts = 3, coarsenings = 3;

class Progress {
 public:
  explicit Progress(const std::function<bool(double)>& callback) : callback_(callback) {}
  void at(double share) const {
    if (callback_ && !callback_(share)) throw Cancelled();
  }

 private:
  const std::function<bool(double)>& callback_;
};

Outline described(const OutlineField& field, const std::vector<Points>& rings) {
  Outline result{};
  for (const Points& ring : rings) {
    result.rings.push_back(field.to_pixels(ring));
    ++(signed_area(ring) > 0.0 ? result.islands : result.holes);
  }
  result.edge = field.edge * field.sample;
  result.margin = field.margin * field.sample;
  result.rounding = field.rounding * field.sample;
  result.sample = field.sample;
  result.dropped_islands = field.dropped_islands;
  result.dropped_pixels = static_cast<Eigen::Index>(
      std::lround(static_cast<double>(field.dropped_samples) * field.sample * field.sample));
  result.filled_holes = field.filled_holes;
  return result;
}

struct Filled {
  PlanarMesh mesh;
  std::vector<int> rings;  ///< points of each
};

/// \param longest edge
/// \param told is called before each triangulation
Filled filled(const Plan& plan, double longest, const std::function<void()>& told) {
  const OutlineField& field = plan.field;
  SizeField sizes = plan.sizes;
  sizes.limit(longest);
  Filled result;
  std::vector<Points> polygons;
  for (const Points& ring : plan.rings) {
    polygons.push_back(boundary_polygon(ring, field.distance, sizes.size, plan.band));
    result.rings.push_back(static_cast<int>(polygons.back().rows()));
    result.mesh.fixed += polygons.back().rows();
  }
  Points boundary(result.mesh.fixed, 2);
  Eigen::Index row = 0;
  for (const Points& polygon : polygons) {
    boundary.middleRows(row, polygon.rows()) = polygon;
    row += polygon.rows();
  }
  const Points inner = interior_points(boundary, field.distance, sizes.size, plan.shortest, longest);
  PlanarMesh& mesh = result.mesh;
  mesh.points.resize(boundary.rows() + inner.rows(), 2);
  mesh.points << boundary, inner;
  const auto triangulate = [&] {
    told();
    mesh.triangles = constrained_delaunay(mesh.points, result.rings);
  };
  triangulate();
  for (int i = 0; i < gap_rounds; ++i) {
    const Points more = gap_points(mesh.points, mesh.triangles, field.distance, sizes.size, longest);
    if (more.rows() == 0) break;
    mesh.points.conservativeResize(mesh.points.rows() + more.rows(), 2);
    mesh.points.bottomRows(more.rows()) = more;
    triangulate();
  }
  for (int i = 0; i < smoothings; ++i) {
    smooth_towards_centroids(mesh, field.distance, sizes.size);
    triangulate();
  }
  for (int i = 0; i < widenings; ++i) {
    widen_angles(mesh);
    triangulate();
  }
  return result;
}

/// Points that are in no triangle are left out.
void keep_used(PlanarMesh& mesh) {
  std::vector<int> row(at(mesh.points.rows()), -1);
  for (Eigen::Index i = 0; i < mesh.fixed; ++i) row[at(i)] = 0;
  for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) row[at(mesh.triangles.data()[i])] = 0;
  int n = 0;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    if (row[at(i)] < 0) continue;
    mesh.points.row(n) = mesh.points.row(i).eval();
    row[at(i)] = n++;
  }
  mesh.points.conservativeResize(n, 2);
  for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i)
    mesh.triangles.data()[i] = row[at(mesh.triangles.data()[i])];
}

struct Attempt {
  Filled filled;
  double edge = 0.0;  ///< its longest
};

/// The mesh of a plan that is nearest to the wish.
///
/// \param told is called with the part that is done of what is left
Attempt attempted(const Plan& plan, const CutoutOptions& options, const std::function<void(double)>& told) {
  const double wished = options.vertices;
  Attempt best;
  double edge = plan.longest, wish = wished, off = 0.0;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    if (!options.edge) edge = plan.sizes.edge_for(wish);
    require_vertices(plan.sizes.vertices_for(edge));
    Filled now = filled(plan, edge, [&] { told(0.5 / triangulations); });
    const auto n = static_cast<double>(now.mesh.points.rows());
    if (attempt == 0 || std::abs(std::log(n / wished)) < std::abs(off)) {
      off = std::log(n / wished);
      best = {std::move(now), edge};
    }
    const bool bound =
        (n > wished && edge >= 0.999 * plan.longest) || (n < wished && edge <= 1.001 * plan.shortest);
    if (options.edge || bound || std::abs(n / wished - 1.0) <= near_wish_at_once) break;
    wish *= wished / n;
  }
  keep_used(best.filled.mesh);
  return best;
}

std::string count_of(Eigen::Index n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

}  // namespace

Outline outline(const AlphaImage& alpha, const CutoutOptions& options) {
  require_options(options);
  const Progress progress(options.progress);
  progress.at(0.0);
  const ArtMask art = art_mask(alpha, options);
  progress.at(0.2);
  const OutlineField field = outline_field(art, options, 0.0);
  progress.at(0.8);
  Outline result = described(field, rings_of(field));
  progress.at(1.0);
  return result;
}

Cutout cutout(const AlphaImage& alpha, const CutoutOptions& options) {
  require_options(options);
  const Progress progress(options.progress);
  progress.at(0.0);
  // How many rounds there are is not known: each has a part of what is left.
  double share = 0.0;
  const auto told = [&](double part) { progress.at(share += part * (1.0 - share)); };
  Planner planner(alpha, options, [&] { told(0.1); });
  Plan plan = planner.of_wish();

  Cutout result{};
  const double wished = options.vertices, most = (1.0 + near_wish) * wished;
  Attempt best;
  double target = wished;
  for (int i = 0; i < coarsenings; ++i) {
    if (!options.edge && plan.least() > (i == 0 ? most : target) && !planner.is_coarsest(plan))
      plan = planner.enough_for(target, plan);
    best = attempted(plan, options, told);
    const auto n = static_cast<double>(best.filled.mesh.points.rows());
    if (options.edge || n <= most || planner.is_coarsest(plan)) break;
    target = i + 2 < coarsenings ? std::min(target * wished / n, 0.95 * plan.least()) : 0.0;  // the coarsest
  }

  const OutlineField& field = plan.field;
  const PlanarMesh& made = best.filled.mesh;
  result.outline = described(field, plan.rings);
  result.edge = best.edge * field.sample;
  const auto n = made.points.rows();
  result.points = field.to_pixels(made.points);
  result.triangles = made.triangles;
  const Mesh mesh(n, result.triangles);
  result.parts = Eigen::Map<const Eigen::VectorXi>(mesh.part.data(), n);
  result.n_parts = mesh.n_parts;
  int first = 0;
  for (const int size : best.filled.rings) {
    result.rings.push_back(Eigen::VectorXi::LinSpaced(size, first, first + size - 1));
    first += size;
  }
  result.shortest = plan.shortest * field.sample;
  const double ratio = static_cast<double>(n) / wished;
  result.reached = options.edge || (ratio <= 1.0 + near_wish && ratio >= 1.0 - near_wish);
  if (!result.reached) {
    const std::string all = std::to_string(n) + " vertices";
    // A margin that was given holds edges short in thin parts, until it is that of the coarsest edge.
    const char* less = planner.margin_holds(plan) ? "; with a larger margin fewer." : ".";
    result.said.push_back(ratio > 1.0 ? "This drawing needs at least " + all + less
                                      : "This drawing has room for " + all + ".");
  }
  if (field.dropped_islands > 0) {
    result.said.push_back(
        "Left out as specks: " + count_of(result.outline.dropped_islands, "island", "islands") + ", " +
        count_of(result.outline.dropped_pixels, "pixel", "pixels") + " in all.");
  }
  progress.at(1.0);
  return result;
}

}  // namespace planar
