// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/block_kinds.h"

#ifdef PLANAR_AVX2
#include <cpuid.h>

namespace planar {

// Not __builtin_cpu_supports: it asks the compiler's runtime library, and zig's always says no.
bool has_avx2() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid(1, &a, &b, &c, &d) == 0) return false;
  constexpr unsigned needed = bit_FMA | bit_OSXSAVE | bit_AVX;
  if ((c & needed) != needed) return false;
  // Whether the system keeps the registers of SSE and AVX when it changes threads (Intel SDM, vol. 1, 14.3).
  unsigned kept = 0, high = 0;
  __asm__("xgetbv" : "=a"(kept), "=d"(high) : "c"(0));
  if ((kept & 6U) != 6U) return false;
  return __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (b & bit_AVX2) != 0;
}

}  // namespace planar
#endif
