// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "drags.h"
#include "inbetweens.h"
#include "lattices.h"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  planar::benchmarks::print_drags();
  planar::benchmarks::print_inbetweens();
  planar::benchmarks::print_lattices();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
