// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/sparse_solver.h"

#include <stdexcept>

#include "linear/eigen_solver.h"
#ifdef PLANAR_CHOLMOD
#include "linear/cholmod_solver.h"
#endif

namespace planar {

#ifdef PLANAR_CHOLMOD

Backend default_backend() { return Backend::cholmod; }

std::unique_ptr<SparseSolver> SparseSolver::create(Backend backend) {
  return backend == Backend::cholmod ? make_cholmod_solver() : make_eigen_solver();
}

#else

Backend default_backend() { return Backend::eigen; }

std::unique_ptr<SparseSolver> SparseSolver::create(Backend backend) {
  if (backend == Backend::cholmod) throw std::invalid_argument("this build has no CHOLMOD");
  return make_eigen_solver();
}

#endif

}  // namespace planar
