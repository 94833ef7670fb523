// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/block_solve.h"

#include "linear/block_kinds.h"
#include "linear/block_solve_tiles.h"

namespace planar {

namespace {

void for_any_strips(double* x, int columns, const auto& solve) {
#ifdef __GNUC__
  using Pair = double __attribute__((vector_size(16)));
  for_strips<Pair, double>(x, columns, columns, solve);
#else
  for_strips<double>(x, columns, columns, solve);
#endif
}

}  // namespace

void solve_forward_any(const FactorBlock& block, double* x, int columns) {
  for_any_strips(x, columns, [&block](const auto& strip) { strip.forward(block); });
}

void solve_backward_any(const FactorBlock& block, double* x, int columns) {
  for_any_strips(x, columns, [&block](const auto& strip) { strip.backward(block); });
}

namespace {

struct Solves {
  void (*forward)(const FactorBlock&, double*, int);
  void (*backward)(const FactorBlock&, double*, int);
};

const Solves& of_this_processor() {
#ifdef PLANAR_AVX2
  static const Solves chosen = has_avx2() ? Solves{solve_forward_avx2, solve_backward_avx2}
                                          : Solves{solve_forward_any, solve_backward_any};
#else
  static const Solves chosen{solve_forward_any, solve_backward_any};
#endif
  return chosen;
}

}  // namespace

void solve_forward(const FactorBlock& block, double* x, int columns) {
  of_this_processor().forward(block, x, columns);
}

void solve_backward(const FactorBlock& block, double* x, int columns) {
  of_this_processor().backward(block, x, columns);
}

}  // namespace planar
