// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "energy/newton.h"
#include "inbetween/blended_triangles.h"
#include "mesh/mesh.h"
#include "parallel/per_thread.h"

namespace planar {

/// Takes frames in which triangles are flipped to near ones in which none is: minimises
///
///   4u(1-u) E_u(x) + w Σ m |x - y|²
///
/// from a shape without flips, with y the frame at u, E_u the rest energy of the keys' blended triangles, m
/// an equal share of the area and w = 10 / (size/50)², the size being the keys' largest diameter. E_u is
/// least at the keys for the keys themselves, so that the solution leaves y slowly; with the factor before it
/// it even has the velocities of y there. Steps towards the minimum of E_u alone are to be had as well.
class FrameTracker {
 public:
  /// For the threads of a team, which must not share one.
  static PerThread<FrameTracker> one_a_thread(const ThreadTeam& team, const Triangles& triangles,
                                              const Points& from, const Points& to);

  /// \param triangles of the parts to work on; other vertices stay
  FrameTracker(const Triangles& triangles, const Points& from, const Points& to);
  FrameTracker(const FrameTracker&) = delete;
  FrameTracker& operator=(const FrameTracker&) = delete;

  /// The minimum for the frame y at u, from the solution x of a frame `of` near to it, until a step is at
  /// most `tolerance` of the keys' size, or as near to it as numbers lead.
  Points follow(const Points& x, const Points& of, const Points& y, double u, double tolerance);
  /// Whether the last follow() got that far.
  bool converged() const { return converged_; }

  /// A projected Newton step of E_u alone.
  struct Step {
    Points direction;
    double collapse = 0.0;  ///< the least t at which x + t direction has a triangle without area
    double energy = 0.0;    ///< E_u(x); not finite where a triangle is flat
    double slope = 0.0;     ///< of E_u along direction
  };
  /// From x without flips. Places, which the energy does not tell, hardly change.
  /// \throw SolveError the Hessian cannot be factorized
  Step step_at(const Points& x, double u);
  double energy_of(const Points& x, double u) { return energy_at(u).value(x); }

  /// Of the triangles, the mean of both keys: energies are known to a share of it.
  double area() const { return area_of_keys_; }

 private:
  /// A pull of all vertices in parts towards y.
  struct Pull final : Springs {
    explicit Pull(const Mesh& mesh_) : mesh(mesh_) {}
    double value(const Points& x, Points* gradient) const override;
    void add_hessian(MeshMatrix& matrix, double scale) const override;
    const Mesh& mesh;
    Points y;
    double strength = 0.0;
  };

  Points predicted(const Points& x, const Points& of, const Points& y) const;
  RestEnergy energy_at(double u);

  Mesh mesh_;
  BlendedTriangles blended_;
  Orientation orientation_;
  double area_of_keys_;  ///< their mean
  Pull springs_;
  Newton newton_;
  double pull_;  ///< w m
  bool converged_ = true;
};

}  // namespace planar
