// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/paper_lattice.h"

#include <cmath>
#include <utility>

#include "lattice/lattice_frame.h"
#include "lattice/sub_cells.h"
#include "linear/anderson.h"

namespace planar {

namespace {

constexpr int sample_parts_2d = 4, sample_parts_3d = 2;  // of a cell along each axis
constexpr double worth_sampling = 0.25;                  // of the rings: more samples are not worth it
constexpr int move_budget = 4;
constexpr int settle_budget = 1000;
constexpr double settled = 1e-6;  // of the size: a change of the points after which nothing is left to do

}  // namespace

template <int D>
PaperLattice<D>::PaperLattice(const Rows<D>& rest, const Elements& elements, const LatticeWeights& weights,
                              const Rows<D>& lattice_rest, double size, const PaperWeights& options)
    : weights_(weights), lattice_rest_(lattice_rest), size_(size), rigid_following_(options.rigid_following) {
  const WeightedEdges edges =
      options.by_area ? area_edges(rest, elements) : uniform_edges(rest.rows(), elements);
  const std::vector<std::array<int, 2>> coupled = couplings(weights, edges.edge);
  const auto make = [&](RingEnergy<D> rings) {
    return PaperSystem<D>(std::move(rings), lattice_rest, coupled, options.shape, options.rest,
                          options.rigid_following);
  };
  exact_.emplace(make(RingEnergy<D>(rest, weights, edges)));
  const Eigen::VectorXd measures = RingEnergy<D>::measures(rest, edges);
  std::vector<int> weighty;
  for (int i = 0; i < static_cast<int>(measures.size()); ++i) {
    if (measures[i] > 0.0) weighty.push_back(i);
  }
  const Eigen::VectorXd their = measures(weighty);
  const SubCells cells(LatticeFrame(lattice_rest).in_steps(rest(weighty, Eigen::all)), their,
                       D == 2 ? sample_parts_2d : sample_parts_3d);
  const auto n = static_cast<Eigen::Index>(cells.middle.size());
  if (n == 0 || static_cast<double>(n) > worth_sampling * static_cast<double>(rest.rows())) return;
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
typename PaperLattice<D>::Outcome PaperLattice<D>::move(const LatticeSprings<D>& springs,
                                                        LatticePose<D>& pose) {
  PaperSystem<D>& system = sampled_ ? *sampled_ : *exact_;
  if (rigid_following_) {
    // The lowest of the states to begin at; the pose itself wins a draw.
    double least = system.step(springs, pose.d, nullptr);
    for (Rows<D>& state : starts<D>(springs, lattice_rest_, pose.d)) {
      const double energy = system.step(springs, state, nullptr);
      if (!(energy < least)) continue;
      least = energy;
      pose.d = std::move(state);
    }
  }
  Outcome outcome = iterate(system, springs, move_budget, pose);
  if (sampled_) outcome.converged = false;
  return outcome;
}

template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::refine(const LatticeSprings<D>& springs,
                                                          LatticePose<D>& pose) {
  return iterate(*exact_, springs, move_budget, pose);
}

template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::settle(const LatticeSprings<D>& springs,
                                                          LatticePose<D>& pose) {
  return iterate(*exact_, springs, settle_budget, pose);
}

template <int D>
typename PaperLattice<D>::Outcome PaperLattice<D>::iterate(PaperSystem<D>& system,
                                                           const LatticeSprings<D>& springs, int budget,
                                                           LatticePose<D>& pose) {
  Rows<D>& d = pose.d;
  Rows<D> mapped;
  const auto flat = [](const Rows<D>& rows) {
    return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
  };
  const auto step = [&](const Eigen::VectorXd& at, Eigen::VectorXd& result) {
    d = Eigen::Map<const Rows<D>>(at.data(), d.rows(), D);
    const double energy = system.step(springs, d, &mapped);
    result = flat(mapped);
    return energy;
  };
  const auto small = [&](const Eigen::VectorXd&, const Eigen::VectorXd&) {
    return std::sqrt((mapped - d).rowwise().squaredNorm().maxCoeff()) <= settled * size_;
  };
  Eigen::VectorXd x = flat(d);
  const FixedPointOutcome outcome = accelerate(step, small, budget, x);
  d = Eigen::Map<const Rows<D>>(x.data(), d.rows(), D);
  product<D>(weights_, d, pose.u);
  return {outcome.iterations, outcome.converged};
}

template class PaperLattice<2>;
template class PaperLattice<3>;

}  // namespace planar
