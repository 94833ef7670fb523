// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lattice/lattice_method.h"
#include "lattice/paper_system.h"

namespace planar {

struct PaperWeights {
  double shape, rest;
  bool rigid_following;
  bool by_area;
};

/// "paper": the header of planar/lattice.h says what it minimises and how.
template <int D>
class PaperLattice : public LatticeMethod<D> {
 public:
  using Outcome = typename LatticeMethod<D>::Outcome;

  /// \param weights, lattice_rest must outlive this
  /// \param size of the rest: lengths are small or large beside it
  PaperLattice(const Rows<D>& rest, const Elements& elements, const LatticeWeights& weights,
               const Rows<D>& lattice_rest, double size, const PaperWeights& options);

  void compile(const LatticeSprings<D>& springs) override;
  Outcome move(const LatticeSprings<D>& springs, LatticePose<D>& pose) override;
  Outcome refine(const LatticeSprings<D>& springs, LatticePose<D>& pose) override;
  Outcome settle(const LatticeSprings<D>& springs, LatticePose<D>& pose) override;

 private:
  Outcome iterate(PaperSystem<D>& system, const LatticeSprings<D>& springs, int budget, LatticePose<D>& pose);

  const LatticeWeights& weights_;
  const Rows<D>& lattice_rest_;
  double size_;
  bool rigid_following_;
  std::optional<PaperSystem<D>> exact_, sampled_;
};

}  // namespace planar
