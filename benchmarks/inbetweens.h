// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace planar::benchmarks {

/// Prints what in-betweening costs, beside the paper's times, the dense reading of (9), and a blend of polar
/// decompositions with one Poisson solve a frame.
void print_inbetweens();

}  // namespace planar::benchmarks
