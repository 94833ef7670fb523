// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/paper_lattice.h"

#include <cmath>
#include <utility>

#include "lattice/anderson.h"
#include "lattice/lattice_frame.h"
#include "lattice/sub_cells.h"

namespace planar {

namespace {

constexpr int sample_parts = 2;          // of a cell along each axis
constexpr double worth_sampling = 0.25;  // of the rings: more samples are not worth it
constexpr int move_budget = 4;
constexpr int settle_budget = 1000;
constexpr std::size_t window = 8;  // of Anderson's acceleration
constexpr double settled = 1e-6;   // of the size: a change of the points after which nothing is left to do

}  // namespace

template <int D>
PaperLattice<D>::PaperLattice(const Rows<D>& rest, const Elements& elements, const LatticeWeights& weights,
                              const Rows<D>& lattice_rest, double size, const PaperWeights& options)
    : lattice_rest_(lattice_rest), size_(size), rigid_following_(options.rigid_following) {
  const WeightedEdges edges =
      options.by_area ? area_edges(rest, elements) : uniform_edges(rest.rows(), elements);
  const std::vector<std::array<int, 2>> coupled = couplings(weights, edges.edge);
  const auto make = [&](RingEnergy<D> rings) {
    return PaperSystem<D>(std::move(rings), lattice_rest, coupled, options.shape, options.rest,
                          options.rigid_following);
  };
  exact_.emplace(make(RingEnergy<D>(rest, weights, edges)));
  if (D == 2) return;
  const Eigen::VectorXd measures = RingEnergy<D>::measures(rest, edges);
  std::vector<int> weighty;
  for (int i = 0; i < static_cast<int>(measures.size()); ++i) {
    if (measures[i] > 0.0) weighty.push_back(i);
  }
  const Eigen::VectorXd their = measures(weighty);
  const SubCells cells(LatticeFrame(lattice_rest).in_steps(rest(weighty, Eigen::all)), their, sample_parts);
  const auto n = static_cast<Eigen::Index>(cells.middle.size());
  if (static_cast<double>(n) > worth_sampling * static_cast<double>(rest.rows())) return;
  std::vector<int> centres;
  Eigen::VectorXd multiple(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const int middle = cells.middle[static_cast<std::size_t>(c)];
    centres.push_back(weighty[static_cast<std::size_t>(middle)]);
    multiple[c] = cells.measure[static_cast<std::size_t>(c)] / their[middle];
  }
  sampled_.emplace(make(RingEnergy<D>(rest, weights, edges, centres, std::move(multiple))));
}

template <int D>
void PaperLattice<D>::compile(const LatticeSprings<D>& springs) {
  exact_->compile(springs);
  if (sampled_) sampled_->compile(springs);
}

template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::move(const LatticeSprings<D>& springs, int /*flipped*/,
                                                        Rows<D>& d) {
  PaperSystem<D>& system = sampled_ ? *sampled_ : *exact_;
  // The lowest of the states to begin at; d itself wins a draw.
  std::vector<Rows<D>> states{d};
  if (rigid_following_) states = starts<D>(springs, lattice_rest_, d);
  std::size_t best = 0;
  double least = system.step(springs, d, nullptr);
  for (std::size_t i = 1; i < states.size(); ++i) {
    const double energy = system.step(springs, states[i], nullptr);
    if (energy < least) {
      least = energy;
      best = i;
    }
  }
  Rows<D> next = std::move(states[best]);
  Outcome outcome = iterate(system, springs, move_budget, next);
  if (sampled_) outcome.converged = false;
  d = std::move(next);
  return outcome;
}

template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::refine(const LatticeSprings<D>& springs, Rows<D>& d) {
  return iterate(*exact_, springs, move_budget, d);
}

template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::settle(const LatticeSprings<D>& springs, Rows<D>& d) {
  return iterate(*exact_, springs, settle_budget, d);
}

/// Accelerated, but for steps that lead up [Peng18].
template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::iterate(PaperSystem<D>& system,
                                                           const LatticeSprings<D>& springs, int budget,
                                                           Rows<D>& d) {
  Outcome outcome;
  Anderson anderson(window);
  Rows<D> mapped, plain;
  double last = 0.0;
  bool accelerated = false;
  const auto flat = [](const Rows<D>& rows) {
    return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
  };
  while (outcome.iterations < budget) {
    ++outcome.iterations;
    const double energy = system.step(springs, d, &mapped);
    if (!std::isfinite(energy) || !mapped.allFinite()) {
      if (!accelerated) throw SolveError("the energy is not finite: the targets are too far away");
    }
    if (accelerated && !(energy <= last)) {
      d = plain;
      anderson.restart();
      accelerated = false;
      continue;
    }
    last = energy;
    const double change = std::sqrt((mapped - d).rowwise().squaredNorm().maxCoeff());
    if (change <= settled * size_) {
      d = mapped;
      outcome.converged = true;
      return outcome;
    }
    plain = mapped;
    const Eigen::VectorXd next = anderson.next(flat(d), flat(mapped));
    d = Eigen::Map<const Rows<D>>(next.data(), d.rows(), D);
    accelerated = true;
  }
  if (accelerated) {
    // The last one was not looked at: what is known to lead down is returned.
    d = plain;
  }
  return outcome;
}

template class PaperLattice<2>;
template class PaperLattice<3>;

}  // namespace planar
