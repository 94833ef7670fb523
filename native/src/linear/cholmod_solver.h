// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linear/sparse_solver.h"

namespace planar {

/// \throw SolveError CHOLMOD cannot start
std::unique_ptr<SparseSolver> make_cholmod_solver();
std::unique_ptr<HermitianSolver> make_cholmod_hermitian_solver();

}  // namespace planar
