// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cage/half_edges.h"
#include "planar/types.h"

namespace planar {

/// What a vertex of an even mesh has of the area, in squared edges.
constexpr double vertex_cell = 0.866;

/// A coarse mesh made from a dense one, and which of its triangles each dense vertex lies in or next to.
struct Coarse {
  Points points;                 ///< c×2
  Triangles triangles;           ///< counter-clockwise
  std::vector<double> sizes;     ///< c: wished lengths of edges
  std::vector<int> triangle_of;  ///< n; -1: in no triangle of the dense mesh

  /// c: the dense vertex that each was made from, or two vertices before it that it was put between.
  struct Origin {
    int source;
    int a, b;
  };
  std::vector<Origin> origins;
};

/// A mesh that is changed in place, under the dense vertices: each keeps to the triangles that take the place
/// of the one it lies in, so that none gets into another part of the mesh, wherever that lies.
class CarriedMesh {
 public:
  /// 1 for an equilateral triangle, 0 without area, below 0 if clockwise.
  static double quality(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b,
                        const Eigen::RowVector2d& c);

  /// \param dense n×2, to outlive this
  /// \param triangle_of n
  CarriedMesh(const Points& dense, Points points, const Triangles& triangles,
              const std::vector<int>& triangle_of);

  const Points& dense() const { return dense_; }
  const HalfEdges& mesh() const { return mesh_; }
  Eigen::RowVector2d at_vertex(int v) const { return points_.row(v); }
  double length(int a, int b) const { return (at_vertex(a) - at_vertex(b)).norm(); }
  double quality_of(int triangle) const;
  double area_of(int triangle) const;
  int count_in(int triangle) const;

  bool can_collapse(const HalfEdges::Side& side) { return mesh_.can_collapse(side); }
  void collapse(const HalfEdges::Side& side);
  /// Puts a new vertex onto the middle of the edge of h, and gives its number, the next one.
  int split(int h);
  /// \param rows edges between two boundary vertices are made only where there were such
  void flip_to_delaunay(bool rows);
  /// Moves an inner vertex to the mean of its triangles' centroids, weighted by area over squared size
  /// [Chen04], if its triangles stay good.
  void smooth(int v, const std::vector<double>& sizes);

  /// Without those that are gone; vertices by their numbers.
  Triangles triangles(const std::vector<int>& number) const;
  /// triangle_of, with triangles numbered as these.
  std::vector<int> owners() const;

 private:
  bool wants_flip(int h, bool rows) const;
  void take(const std::vector<int>& triangles);
  void put(const std::vector<int>& triangles);

  const Points& dense_;
  Points points_;
  HalfEdges mesh_;
  std::vector<int> head_, link_;  ///< lists of the dense vertices, by triangle
  std::vector<int> taken_;        ///< out of the lists, to be put back
  std::vector<int> star_;
};

}  // namespace planar
