// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "killing_energy.h"
#include "planar/poser.h"
#include "sparse_solver.h"
#include "spirals.h"

/// A move of the Poser beside its parts and one bare factorization (numeric only, of K plus two handles, in
/// the backend's own order), on square meshes of about 1k to 100k vertices.
namespace planar {
namespace {

struct Square {
  explicit Square(int n_vertices) : side(static_cast<int>(std::lround(std::sqrt(n_vertices)))) {
    vertices.resize(side * side, 2);
    for (int i = 0; i < side * side; ++i) {
      // Off the grid, so that no entry of K is zero by symmetry.
      vertices.row(i) << i % side + 0.2 * std::sin(7.0 * i), i / side + 0.2 * std::cos(3.0 * i);
    }
    triangles.resize(2 * (side - 1) * (side - 1), 3);
    int row = 0;
    for (int j = 0; j + 1 < side; ++j) {
      for (int i = 0; i + 1 < side; ++i) {
        const int a = j * side + i;
        triangles.row(row++) << a, a + 1, a + side;
        triangles.row(row++) << a + 1, a + side + 1, a + side;
      }
    }
  }
  int side;
  Points vertices;
  Triangles triangles;
};

/// The system of one mesh, assembled, with two handles.
struct System {
  explicit System(const Square& square)
      : mesh(square.vertices.rows(), square.triangles), solver(SparseSolver::create(default_backend())) {
    std::vector<int> kept(static_cast<std::size_t>(mesh.n_vertices));
    std::iota(kept.begin(), kept.end(), 0);
    killing.emplace(mesh, solver->fill_reducing_order(vertex_graph(mesh, kept)));
    solver->analyze(killing->matrix());
    assemble(square);
    solver->factorize(killing->matrix());
  }
  void assemble(const Square& square) {
    killing->assemble(square.vertices, {}, {1});
    for (const int v : {0, mesh.n_vertices - 1}) killing->add(v, v, 1.0);
  }
  Mesh mesh;
  std::unique_ptr<SparseSolver> solver;
  std::optional<KillingMatrix> killing;
};

double milliseconds(auto&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What the process holds in memory, in MB; 0 where /proc does not tell.
double resident() {
  long pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident_pages;
  return static_cast<double>(resident_pages) * 4096.0 / 1e6;
}

void bare_factorization(benchmark::State& state) {
  const Square square(static_cast<int>(state.range(0)));
  System system(square);
  for (auto _ : state) system.solver->factorize(system.killing->matrix());
}

void assembly(benchmark::State& state) {
  const Square square(static_cast<int>(state.range(0)));
  System system(square);
  for (auto _ : state) system.assemble(square);
}

void one_solve(benchmark::State& state) {
  const Square square(static_cast<int>(state.range(0)));
  System system(square);
  Eigen::VectorXd x = Eigen::VectorXd::Ones(system.killing->matrix().size);
  for (auto _ : state) system.solver->solve(x, x);
}

void log_spirals(benchmark::State& state) {
  const Square square(static_cast<int>(state.range(0)));
  Spirals spirals(Mesh(square.vertices.rows(), square.triangles));
  Points result;
  const Points velocities = 0.01 * square.vertices;
  for (auto _ : state) {
    spirals.prepare(square.vertices, velocities);
    spirals.advance(1.0, result);
  }
}

void analysis(benchmark::State& state) {
  const Square square(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    Poser poser(square.vertices, square.triangles);
    poser.set_handles(
        Handles::at_vertices(Eigen::Vector2i(0, square.side * (square.side / 2)), square.vertices.rows()));
  }
}

/// Moves of one substep with handles inside and on the boundary, so that both systems are solved. Each is
/// followed by a bare factorization, so that both meet the same noise; `ratio` is that of their medians.
void move(benchmark::State& state) {
  const Square square(static_cast<int>(state.range(0)));
  System system(square);
  const double before = resident();
  Poser poser(square.vertices, square.triangles);
  const int n = square.side, middle = n * (n / 2) + n / 2;
  const Handles handles = Handles::at_vertices(Eigen::Vector4i(0, n * n - 1, middle, middle + n / 4), n * n);
  poser.set_handles(handles);
  Points targets = handles.positions(square.vertices);
  std::vector<double> moves, factors;
  int substeps = 0;
  double step = 0.02;
  poser.move(targets);
  for (auto _ : state) {
    targets(2, 0) += step;
    targets(2, 1) -= 0.5 * step;
    step = -step;
    moves.push_back(milliseconds([&] { poser.move(targets); }));
    factors.push_back(milliseconds([&] { system.solver->factorize(system.killing->matrix()); }));
    substeps = std::max(substeps, poser.report().substeps);
    state.SetIterationTime(moves.back() / 1e3);
  }
  state.counters["move_ms"] = median(moves);
  state.counters["bare_ms"] = median(factors);
  state.counters["ratio"] = median(moves) / median(factors);
  state.counters["substeps"] = substeps;
  state.counters["MB"] = resident() - before;
}

void sizes(benchmark::internal::Benchmark* run) {
  run->Arg(1000)->Arg(5000)->Arg(10000)->Arg(50000)->Arg(100000)->Unit(benchmark::kMillisecond);
}

BENCHMARK(move)->Apply(sizes)->UseManualTime();
BENCHMARK(bare_factorization)->Apply(sizes);
BENCHMARK(assembly)->Apply(sizes);
BENCHMARK(one_solve)->Apply(sizes);
BENCHMARK(log_spirals)->Apply(sizes);
BENCHMARK(analysis)->Apply(sizes);

}  // namespace
}  // namespace planar

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  std::string tabular = "--benchmark_counters_tabular=true";
  arguments.insert(arguments.begin() + 1, tabular.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
