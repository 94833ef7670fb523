// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "drags.h"
#include "inbetweens.h"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  planar::benchmarks::print_drags();
  planar::benchmarks::print_inbetweens();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
