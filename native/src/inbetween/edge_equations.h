// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <complex>

namespace planar {

/// The vectors of an edge, frame by frame.
using EdgeRow = Eigen::Array<std::complex<double>, 1, Eigen::Dynamic, Eigen::RowMajor>;

/// The normal equations of [AIAP 9], forward and reverse, for an edge's inner frames, c that of the edge as
/// it is by [AIAP 8]: |e[k+1] - (1 + iα_k) e[k]|² + |(1 - iβ_k) e[k+1] - e[k]|², summed, with the frames at
/// the ends given. Tridiagonal; arrays of a number for each inner frame, of which below[k] is entry (k+1, k)
/// and the last says nothing.
void edge_equations(const Eigen::Ref<const EdgeRow>& e, double* diagonal, std::complex<double>* below,
                    std::complex<double>* right);

/// Minimises [AIAP 9], forward and reverse, over the inner entries of e, c that of e as it is by [AIAP 8].
void minimise_edge_energy(Eigen::Ref<EdgeRow> e);

}  // namespace planar
