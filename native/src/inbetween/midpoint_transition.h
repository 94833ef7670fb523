// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "inbetween/frame_assembler.h"
#include "inbetween/key_slopes.h"
#include "parallel/thread_team.h"

namespace planar {

/// Minimises Σ |e[k+1] - e[k] - iτ_k (e[k] + e[k+1])|² over the inner entries of e (at most 65 in all), with
/// τ_k that of e as it is: Im(conj(s) d) / |s|², s and d the sum and difference of e[k] and e[k+1]. In place
/// of the tridiagonal system: with e[k] = U_k f[k], U_k the rotations that the τ make, the sum is Σ (1 +
/// τ_k²) |f[k+1] - f[k]|², so that f goes straight from f[0] to f[m].
void minimise_midpoint_energy(
    Eigen::Ref<Eigen::Array<std::complex<double>, 1, Eigen::Dynamic, Eigen::RowMajor>> e);

/// How the edges of a shape move from one key to the next, by the midpoint rule; see planar/inbetween.h. All
/// edge vectors here are seen in a frame that turns with the edge's part, by part_turns in the whole
/// transition, at a constant rate.
class MidpointTransition {
 public:
  struct Settings {
    double tolerance;  ///< of [AIAP 11], in the unit of the positions
    int max_iterations;
    std::function<void(double)> progress;  ///< share of the work done; may throw
  };

  /// \param edge_turns radians, one an edge, from `from` to `to`
  /// \param part_turns radians, one a part
  /// \throw SolveError the numbers overflow
  MidpointTransition(const EdgeGraph& graph, const FrameAssembler& assembler, const Points& from,
                     const Points& to, const Eigen::VectorXd& edge_turns, const Eigen::VectorXd& part_turns,
                     const Settings& settings, ThreadTeam& team);

  /// Edge vectors at u from 0 to 1, into one column. Outside, angles go on straight and lengths
  /// exponentially, so that they stay above 0.
  void sample(double u, ComplexRows& edges, Eigen::Index column) const;

  /// Has lengths and angles meet the key between two transitions with the same slopes in time.
  static void join(MidpointTransition& before, MidpointTransition& after, KeyGaps gaps);

  Eigen::Index steps() const { return steps_; }

  /// Of (11), and whether they were enough.
  int iterations() const { return iterations_; }
  bool converged() const { return converged_; }

 private:
  using Table = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  ComplexRows iterate(const EdgeGraph& graph, const FrameAssembler& assembler, const Settings& settings,
                      ThreadTeam& team);
  void relax(const EdgeGraph& graph, const Points& from, const Points& to, const ComplexRows& points,
             const Settings& settings, ThreadTeam& team);
  void sample_outside(double u, ComplexRows& edges, Eigen::Index column) const;
  double first_slope(const Table& of, Eigen::Index edge) const;
  double last_slope(const Table& of, Eigen::Index edge) const;

  Eigen::Index steps_;
  int iterations_ = 0;
  bool converged_ = false;
  ComplexRows edges_;                                              ///< frames 0..steps_
  Table length_, angle_;                                           ///< of edges_
  std::vector<SlopeChange<double>> length_change_, angle_change_;  ///< none unless joined
};

}  // namespace planar
