// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace planar::benchmarks {

/// Prints what moves of a LatticeSolver cost, both methods, beside one bare product of weights and points.
void print_lattices();

}  // namespace planar::benchmarks
