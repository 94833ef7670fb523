// SPDX-License-Identifier: GPL-3.0-or-later
#include "systems.h"

#include <omp.h>

#include <numeric>
#include <vector>

extern "C" {
[[gnu::weak]] void openblas_set_num_threads(int n_threads);
}

namespace planar::benchmarks {

OwnSystem::OwnSystem(const Shape& shape)
    : mesh_(shape.vertices.rows(), shape.triangles), solver_(SparseSolver::create(default_backend())) {
  std::vector<int> kept(static_cast<std::size_t>(mesh_.n_vertices));
  std::iota(kept.begin(), kept.end(), 0);
  killing_.emplace(mesh_, solver_->fill_reducing_order(vertex_graph(mesh_, kept)));
  solver_->analyze(killing_->matrix());
  assemble(shape);
  factorize();
}

void OwnSystem::assemble(const Shape& shape) {
  killing_->assemble(shape.vertices, {}, {1});
  for (const int v : {0, mesh_.n_vertices - 1}) killing_->add(v, v, 1.0);
}

void OwnSystem::solve() {
  unknown_.setZero(matrix().size);
  for (const int v : {0, mesh_.n_vertices - 1}) unknown_[2 * killing_->slot(v)] = 1.0;
  solver_->solve(unknown_, unknown_);
}

BareSystem::BareSystem(const SymmetricMatrix& lower) {
  // As CHOLMOD is at its best here: a tenth faster with larger supernodes than by default, and with one
  // thread, in the BLAS (if that is OpenBLAS) and in factorize().
  if (openblas_set_num_threads) openblas_set_num_threads(1);
  cholmod_start(&common_);
  common_.supernodal = CHOLMOD_SUPERNODAL;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_NATURAL;
  common_.postorder = 0;
  common_.nrelax[0] = 12;
  common_.nrelax[1] = 24;
  common_.nrelax[2] = 48;
  common_.zrelax[0] = 0.9;
  common_.zrelax[1] = 0.3;
  common_.zrelax[2] = 0.05;
  matrix_.nrow = matrix_.ncol = static_cast<std::size_t>(lower.size);
  matrix_.nzmax = lower.row.size();
  matrix_.p = const_cast<int*>(lower.column_start.data());
  matrix_.i = const_cast<int*>(lower.row.data());
  matrix_.x = const_cast<double*>(lower.value.data());
  matrix_.stype = -1;
  matrix_.itype = CHOLMOD_INT;
  matrix_.xtype = CHOLMOD_REAL;
  matrix_.dtype = CHOLMOD_DOUBLE;
  matrix_.sorted = matrix_.packed = 1;
  factor_ = cholmod_analyze(&matrix_, &common_);
  factorize();
}

BareSystem::~BareSystem() {
  cholmod_free_factor(&factor_, &common_);
  cholmod_finish(&common_);
}

void BareSystem::factorize() {
  // CHOLMOD 3 opens a fixed number of threads per supernode, and is several times slower for it.
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(0);
  cholmod_factorize(&matrix_, factor_, &common_);
  omp_set_max_active_levels(levels);
}

}  // namespace planar::benchmarks
