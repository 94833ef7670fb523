// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linear/sparse_solver.h"

namespace planar {

std::unique_ptr<SparseSolver> make_eigen_solver();
std::unique_ptr<HermitianSolver> make_eigen_hermitian_solver();

}  // namespace planar
