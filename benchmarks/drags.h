// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace planar::benchmarks {

/// Prints what moves of the Poser cost, both methods, beside one bare factorization and one solve.
void print_drags();

}  // namespace planar::benchmarks
