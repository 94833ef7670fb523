// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattices.h"

#include <cstdio>
#include <ctime>
#include <numbers>
#include <vector>

#include "planar/lattice.h"
#include "systems.h"

namespace planar::benchmarks {
namespace {

constexpr int moves = 40;  // of a drag
constexpr int products = 20;

/// A model in a lattice, and handles of which the last one is dragged.
struct Model {
  Coordinates rest;
  Triangles triangles;
  LatticeWeights weights;
  Coordinates points;
  std::vector<int> pins;
  double diagonal;
};

Model in_lattice(Coordinates rest, Triangles triangles, const std::vector<int>& pins,
                 const std::vector<int>& count) {
  const Eigen::VectorXd low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
  LatticeGrid grid{count, std::vector<LatticeBasis>(count.size(), LatticeBasis::bspline), low, high - low};
  Eigen::Index n_points = 1;
  for (std::size_t a = 0; a < count.size(); ++a) {
    // One whole free cell on each side.
    const auto axis = static_cast<Eigen::Index>(a);
    grid.spacing[axis] = (high[axis] - low[axis]) / (count[a] - 3);
    grid.origin[axis] = low[axis] - grid.spacing[axis];
    n_points *= count[a];
  }
  Coordinates points(n_points, rest.cols());
  for (Eigen::Index i = 0; i < n_points; ++i) {
    Eigen::Index left = i;
    for (std::size_t a = 0; a < count.size(); ++a, left /= count[a - 1]) {
      const auto axis = static_cast<Eigen::Index>(a);
      points(i, axis) = grid.origin[axis] + grid.spacing[axis] * static_cast<double>(left % count[a]);
    }
  }
  LatticeWeights weights = lattice_weights(rest, grid);
  const double diagonal = (high - low).norm();
  return {std::move(rest), std::move(triangles), std::move(weights), std::move(points), pins, diagonal};
}

Model flat(int n) {
  const Shape shape = figure(n);
  return in_lattice(shape.vertices, shape.triangles, shape.pins, {14, 14});
}

Model filled(int n) {
  const Shape shape = square(n);
  return in_lattice(shape.vertices, shape.triangles, shape.pins, {14, 14});
}

/// A sphere with waves, rows × 2 rows vertices.
Model sphere(int rows) {
  const int columns = 2 * rows;
  Coordinates rest(rows * columns, 3);
  Triangles triangles(2 * (rows - 1) * columns, 3);
  for (int j = 0, t = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double a = 2.0 * std::numbers::pi * i / columns, b = std::numbers::pi * (j + 0.5) / rows;
      const double r = 1.0 + 0.1 * std::sin(5.0 * a) * std::sin(4.0 * b);
      rest.row(j * columns + i) << r * std::cos(a) * std::sin(b), r * std::sin(a) * std::sin(b),
          r * std::cos(b);
      if (j + 1 == rows) continue;
      const int next = (i + 1) % columns, low = j * columns, high = low + columns;
      triangles.row(t++) << low + i, low + next, high + next;
      triangles.row(t++) << low + i, high + next, high + i;
    }
  }
  return in_lattice(std::move(rest), std::move(triangles), {0, rows / 2 * columns, (rows - 1) * columns},
                    {8, 8, 8});
}

/// What a call takes of this thread's time, which is all that it takes: other work on the machine does not
/// count.
double cpu_milliseconds(auto&& call) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  call();
  return now() - start;
}

/// Milliseconds of one product, and of a drag's median and slowest move, of an exact iteration, and of all
/// that is made before.
struct Times {
  double product, ready, move, slowest, exact;
  int iterations;
};

Times measure(const Model& model, LatticeMethodKind method) {
  Times times{};
  LatticeOptions options;
  options.method = method;
  std::vector<double> each;
  Coordinates positions;
  for (int i = 0; i < products; ++i) {
    each.push_back(cpu_milliseconds([&] { positions.noalias() = model.weights * model.points; }));
  }
  times.product = quantile(each, 0.5);
  std::optional<LatticeSolver> solver;
  const auto k = static_cast<Eigen::Index>(model.pins.size());
  times.ready = cpu_milliseconds([&] {
    solver.emplace(model.rest, model.triangles, model.weights, model.points, options);
    LatticeHandles handles;
    handles.mesh =
        Handles::at_vertices(Eigen::Map<const Eigen::VectorXi>(model.pins.data(), k), model.rest.rows());
    solver->set_handles(handles);
  });
  const Coordinates start = model.rest(model.pins, Eigen::all);
  each.clear();
  for (int i = 1; i <= moves; ++i) {
    Coordinates targets = start;
    targets(k - 1, 0) += 0.2 * model.diagonal * i / moves;
    targets(k - 1, 1) += 0.1 * model.diagonal * i / moves;
    each.push_back(cpu_milliseconds([&] { solver->solve(targets, Coordinates()); }));
  }
  times.move = quantile(each, 0.5);
  times.slowest = quantile(each, 1.0);
  each.clear();
  for (int i = 0; i < 5; ++i) {
    const double spent = cpu_milliseconds([&] { solver->refine(); });
    if (solver->report().iterations > 0) each.push_back(spent / solver->report().iterations);
  }
  times.exact = quantile(each, 0.5);
  solver->settle();
  times.iterations = solver->report().iterations;
  return times;
}

void print_row(const char* name, const Model& model, LatticeMethodKind method) {
  const Times times = measure(model, method);
  std::printf("%-18s %8d %-6s %8.2f %8.1f %8.2f %8.2f %8.2f %8.1f %7d\n", name,
              static_cast<int>(model.rest.rows()), method == LatticeMethodKind::hold ? "hold" : "paper",
              times.product, times.ready, times.move, times.slowest, times.exact, times.exact / times.product,
              times.iterations);
  std::fflush(stdout);
}

}  // namespace

void print_lattices() {
  Eigen::setNbThreads(1);  // of the bare product, which would share it out
  std::printf(
      "Lattices, ms of one thread: one bare product W P; registering and compiling; a move of a drag (median "
      "and slowest of "
      "%d);\nan exact iteration, and how many products it is worth; iterations to settle. 14x14 and 8x8x8 "
      "BSPLINE.\n%-18s %8s %-6s %8s %8s %8s %8s %8s %8s %7s\n",
      moves, "model", "vertices", "method", "W P", "ready", "move", "slowest", "exact", "/ W P", "settle");
  for (const int n : {1000, 5000, 20000, 100000}) {
    for (const LatticeMethodKind method : {LatticeMethodKind::hold, LatticeMethodKind::paper}) {
      print_row("figure", flat(n), method);
      print_row("square", filled(n), method);
    }
  }
  for (const int rows : {35, 132}) print_row("sphere", sphere(rows), LatticeMethodKind::paper);
  std::printf("\n");
}

}  // namespace planar::benchmarks
