// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/block_solve.h"

#include "linear/block_kinds.h"
#include "linear/block_solve_tiles.h"

namespace planar {

namespace {

#ifdef __GNUC__
using AnyVector = double __attribute__((vector_size(16)));
#else
using AnyVector = double;
#endif

void for_any_strips(double* x, int columns, const auto& solve) {
  if constexpr (sizeof(AnyVector) > sizeof(double)) {
    for_strips<AnyVector, double>(x, columns, columns, solve);
  } else {
    for_strips<double>(x, columns, columns, solve);
  }
}

}  // namespace

void solve_forward_any(const FactorBlock& block, double* x, int columns) {
  for_any_strips(x, columns, [&block](const auto& strip) { strip.forward(block); });
}

void solve_backward_any(const FactorBlock& block, double* x, int columns) {
  for_any_strips(x, columns, [&block](const auto& strip) { strip.backward(block); });
}

void solve_gathered_forward_any(const FactorBlock& block, double* y) {
  Gathered<AnyVector>::forward(block, y);
}

void solve_gathered_backward_any(const FactorBlock& block, double* y) {
  Gathered<AnyVector>::backward(block, y);
}

namespace {

struct Solves {
  void (*forward)(const FactorBlock&, double*, int);
  void (*backward)(const FactorBlock&, double*, int);
  void (*gathered_forward)(const FactorBlock&, double*);
  void (*gathered_backward)(const FactorBlock&, double*);
};

const Solves& of_this_processor() {
  static const Solves chosen = [] {
#ifdef PLANAR_AVX2
    if (has_avx2()) {
      return Solves{solve_forward_avx2, solve_backward_avx2, solve_gathered_forward_avx2,
                    solve_gathered_backward_avx2};
    }
#endif
    return Solves{solve_forward_any, solve_backward_any, solve_gathered_forward_any,
                  solve_gathered_backward_any};
  }();
  return chosen;
}

}  // namespace

void solve_forward(const FactorBlock& block, double* x, int columns) {
  of_this_processor().forward(block, x, columns);
}

void solve_backward(const FactorBlock& block, double* x, int columns) {
  of_this_processor().backward(block, x, columns);
}

void solve_gathered_forward(const FactorBlock& block, double* y) {
  of_this_processor().gathered_forward(block, y);
}

void solve_gathered_backward(const FactorBlock& block, double* y) {
  of_this_processor().gathered_backward(block, y);
}

}  // namespace planar
