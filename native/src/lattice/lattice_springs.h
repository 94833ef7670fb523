// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lattice/weight_rows.h"

namespace planar {

/// What pulls at a lattice: its handles with their targets, Σ w_h |rest_h + W_h d - c_h|² for handles on the
/// mesh [LPFFD 6] and Σ w_p |P⁰_p + d_p - c_p|² for points of the lattice [LPFFD 7]; and which points are
/// locked. d are the displacements of the points.
template <int D>
struct LatticeSprings {
  LatticeWeights rows;     ///< W_h, k×N
  Rows<D> rest;            ///< k×D: where the handles are at rest
  Eigen::VectorXd weight;  ///< w_h
  Rows<D> targets;         ///< c_h

  std::vector<int> points;    ///< numbers
  Rows<D> point_rest;         ///< P⁰_p
  double point_weight = 0.0;  ///< w_p
  Rows<D> point_targets;      ///< c_p

  std::vector<char> is_point, locked;  ///< N flags

  /// No handles, nothing locked.
  explicit LatticeSprings(Eigen::Index n_points);

  bool empty() const { return rows.rows() == 0 && points.empty(); }
  /// Where the handles on the mesh are.
  Rows<D> places(const Rows<D>& d) const;
  /// The energy; its derivatives are added to `gradient` (N×D) if there is one.
  double value(const Rows<D>& d, Rows<D>* gradient) const;
};

/// p -> to + (p - from) turnᵀ.
template <int D>
struct Motion {
  Eigen::Matrix<double, 1, D> from, to;
  Eigen::Matrix<double, D, D> turn;

  Eigen::Matrix<double, 1, D> at(const Eigen::Matrix<double, 1, D>& p) const {
    return to + (p - from) * turn.transpose();
  }
};

/// The rigid motion with the least Σ weight |at(from) - to|², which turns no further than it has to (one
/// pair: not at all).
/// \pre at least one pair; weights above 0
template <int D>
Motion<D> fit_motion(const Rows<D>& from, const Rows<D>& to, const Eigen::VectorXd& weight);

/// The displacements with which points of a lattice make that motion of where they are with d; locked ones
/// stay.
template <int D>
Rows<D> moved_points(const Motion<D>& motion, const Rows<D>& lattice_rest, const Rows<D>& d,
                     const std::vector<char>& locked);

/// States to begin a descent at when targets have moved: those of `d`, of `d` moved as the handles would have
/// it, of the rest moved likewise, and of the rest. Locked points are where `d` has them.
template <int D>
std::vector<Rows<D>> starts(const LatticeSprings<D>& springs, const Rows<D>& lattice_rest, const Rows<D>& d);

}  // namespace planar
