// SPDX-License-Identifier: GPL-3.0-or-later
// The one source that includes CGAL. Its checks print and abort where they fail, hence are left out in every
// build; without GMP and MPFR it needs headers only.
#define CGAL_NDEBUG
#define CGAL_DISABLE_GMP 1
#define CGAL_DISABLE_MPFR 1
// std::unary_function, which C++17 has removed and boost would derive from.
#define BOOST_NO_CXX98_FUNCTION_BASE
#include "cutout/delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <exception>
#include <string>

#include "base/index.h"

namespace planar {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;
using Face = Triangulation::Face_handle;

constexpr int unseen = -1;

/// How many rings are crossed from far outside to each face; in its info.
void count_rings(Triangulation& triangulation) {
  for (Face face : triangulation.all_face_handles()) face->info() = unseen;
  std::vector<Face> open{triangulation.infinite_face()};
  open.front()->info() = 0;
  while (!open.empty()) {
    const Face face = open.back();
    open.pop_back();
    for (int side = 0; side < 3; ++side) {
      const Face other = face->neighbor(side);
      if (other->info() != unseen) continue;
      other->info() = face->info() ^ static_cast<int>(face->is_constrained(side));
      open.push_back(other);
    }
  }
}

Triangles triangulated(const Points& points, const std::vector<int>& rings) {
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> vertices(at(points.rows()));
  Face near;
  std::size_t known = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto vertex = triangulation.insert({points(i, 0), points(i, 1)}, near);
    if (triangulation.number_of_vertices() > known) vertex->info() = static_cast<int>(i);
    known = triangulation.number_of_vertices();
    near = vertex->face();
    vertices[at(i)] = vertex;
  }
  std::size_t first = 0;
  for (const int n : rings) {
    for (int i = 0; i < n; ++i) {
      const auto from = vertices[first + at(i)], to = vertices[first + at((i + 1) % n)];
      if (from != to) triangulation.insert_constraint(from, to);
    }
    first += at(n);
  }
  if (triangulation.dimension() < 2) return Triangles(0, 3);

  count_rings(triangulation);
  std::vector<int> corners;
  for (const Face face : triangulation.finite_face_handles()) {
    if (face->info() == 0) continue;
    for (int corner = 0; corner < 3; ++corner) corners.push_back(face->vertex(corner)->info());
  }
  return Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
}

}  // namespace

Triangles constrained_delaunay(const Points& points, const std::vector<int>& rings) {
  try {
    return triangulated(points, rings);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    throw SolveError("the outline crosses itself");
  }
}

}  // namespace planar
