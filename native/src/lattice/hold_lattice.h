// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lattice/held_system.h"
#include "lattice/lattice_method.h"
#include "mesh/orientation.h"

namespace planar {

/// "hold": the header of planar/lattice.h says what it minimises and how.
class HoldLattice : public LatticeMethod<2> {
 public:
  /// \param rest, weights, lattice_rest must outlive this
  /// \param size of the rest: lengths are small or large beside it
  HoldLattice(const Points& rest, const Triangles& triangles, const LatticeWeights& weights,
              const Points& lattice_rest, double size, double shape_weight, double smooth);

  void compile(const LatticeSprings<2>& springs) override { system_.compile(springs); }
  Outcome move(const LatticeSprings<2>& springs, LatticePose<2>& pose) override;
  Outcome refine(const LatticeSprings<2>& springs, LatticePose<2>& pose) override;
  Outcome settle(const LatticeSprings<2>& springs, LatticePose<2>& pose) override;

 private:
  /// What energy and Hessian are summed over.
  enum class Over { triangles, samples };

  HoldLattice(const Points& rest, const Triangles& triangles, const LatticeWeights& weights,
              const Points& lattice_rest, const LatticeFrame& frame, double size, double shape_weight,
              double smooth);

  Outcome descend(const LatticeSprings<2>& springs, Over over, int budget, LatticePose<2>& pose);
  double value(const LatticeSprings<2>& springs, Over over, const Points& d, const Points& u) const;
  double gradient(const LatticeSprings<2>& springs, Over over, const Points& d, const Points& u);
  double search(const LatticeSprings<2>& springs, Over over, double value, double furthest,
                LatticePose<2>& pose);
  void join(const Points& u, double t, int blocking);
  int lying_wrong(const Points& u);

  const Points& rest_;
  const LatticeWeights& weights_;
  const Points& lattice_rest_;
  double size_, shape_weight_;
  Orientation orientation_;
  HeldShape shape_;
  HeldSystem system_;
  HeldSamples samples_;
  std::size_t n_samples_ = 0;  ///< of samples_: those that are always there; 0: there are none

  Points du_, gradient_, vertex_gradient_, step_, trial_d_, trial_u_, positions_;
  std::vector<double> areas_;
};

}  // namespace planar
