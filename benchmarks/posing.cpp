// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "planar/poser.h"
#include "posing/spirals.h"
#include "systems.h"

/// The parts of a move, each alone, on squares of about 1k to 100k vertices.
namespace planar::benchmarks {
namespace {

void bare_factorization(benchmark::State& state) {
  const OwnSystem own(square(static_cast<int>(state.range(0))));
  BareSystem system(own.matrix());
  for (auto _ : state) system.factorize();
}

void factorization(benchmark::State& state) {
  OwnSystem system(square(static_cast<int>(state.range(0))));
  for (auto _ : state) system.factorize();
}

void assembly(benchmark::State& state) {
  const Shape shape = square(static_cast<int>(state.range(0)));
  OwnSystem system(shape);
  for (auto _ : state) system.assemble(shape);
}

void one_solve(benchmark::State& state) {
  OwnSystem system(square(static_cast<int>(state.range(0))));
  for (auto _ : state) system.solve();
}

void log_spirals(benchmark::State& state) {
  const Shape shape = square(static_cast<int>(state.range(0)));
  Spirals spirals(Mesh(shape.vertices.rows(), shape.triangles));
  Points result;
  const Points velocities = 0.01 * shape.vertices;
  for (auto _ : state) {
    spirals.prepare(shape.vertices, velocities);
    spirals.advance(1.0, result);
  }
}

void analysis(benchmark::State& state) {
  const Shape shape = square(static_cast<int>(state.range(0)));
  const Eigen::Map<const Eigen::VectorXi> pins(shape.pins.data(),
                                               static_cast<Eigen::Index>(shape.pins.size()));
  for (auto _ : state) {
    Poser poser(shape.vertices, shape.triangles);
    poser.set_handles(Handles::at_vertices(pins, shape.vertices.rows()));
  }
}

/// Poser with method arap and the shape's pins.
struct ArapPose {
  explicit ArapPose(int n)
      : shape(square(n)), poser(shape.vertices, shape.triangles, {.method = PoserMethod::arap}) {
    compile();
    targets = handles().positions(shape.vertices);
  }
  Handles handles() const {
    return Handles::at_vertices(
        Eigen::Map<const Eigen::VectorXi>(shape.pins.data(), static_cast<Eigen::Index>(shape.pins.size())),
        shape.vertices.rows());
  }
  void compile() { poser.set_handles(handles()); }

  Shape shape;
  Poser poser;
  Points targets;
};

void arap_compile(benchmark::State& state) {
  ArapPose pose(static_cast<int>(state.range(0)));
  for (auto _ : state) pose.compile();
}

void arap_deform(benchmark::State& state) {
  ArapPose pose(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    pose.targets.bottomRows<1>().array() += 1e-4;
    pose.poser.move(pose.targets);
  }
}

void sizes(benchmark::internal::Benchmark* run) {
  run->Arg(1000)->Arg(5000)->Arg(10000)->Arg(50000)->Arg(100000)->Unit(benchmark::kMillisecond)->MinTime(0.2);
}

BENCHMARK(bare_factorization)->Apply(sizes)->Arg(200000);  // beside the largest drawing of event_cost.py
BENCHMARK(factorization)->Apply(sizes);
BENCHMARK(assembly)->Apply(sizes);
BENCHMARK(one_solve)->Apply(sizes);
BENCHMARK(log_spirals)->Apply(sizes);
BENCHMARK(analysis)->Apply(sizes);
BENCHMARK(arap_compile)->Apply(sizes);
BENCHMARK(arap_deform)->Apply(sizes);

}  // namespace
}  // namespace planar::benchmarks
