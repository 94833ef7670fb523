// SPDX-License-Identifier: GPL-3.0-or-later
#include "drags.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>
#include <vector>

#include "planar/poser.h"
#include "shapes.h"
#include "systems.h"

namespace planar::benchmarks {

namespace {

constexpr double pi = 3.14159265358979323846;

struct Run {
  const char* method;
  PoserMethod kind;
  const char* name;
  Shape (*make)(int n);
  int n;
  int moves;
};

struct Result {
  int vertices;
  double move, slow_move, bare, latency, slow_latency, solve, one_substep;
};

/// Where a hand takes the dragged pin, as offsets in diagonals: once round a loop of a tenth in 120 events,
/// leaning over on the way, slow at its four corners (0.1 to 0.7 % of the diagonal an event).
Eigen::RowVector2d mouse(int event) {
  const double time = event / 120.0;
  const double turn = 2.0 * pi * time + 0.2 * std::sin(8.0 * pi * time);
  return {0.1 * (std::cos(turn) - 1.0), 0.07 * std::sin(turn) + 0.02 * std::sin(2.0 * turn)};
}

Result measure(const Run& run) {
  const Shape shape = run.make(run.n);
  BareSystem bare(shape);
  OwnSystem own(shape);
  Poser poser(shape.vertices, shape.triangles, {.method = run.kind});
  const Handles handles = Handles::at_vertices(
      Eigen::Map<const Eigen::VectorXi>(shape.pins.data(), static_cast<Eigen::Index>(shape.pins.size())),
      shape.vertices.rows());
  poser.set_handles(handles);
  const Points start = handles.positions(shape.vertices);
  int event = 0;
  const auto move = [&] {
    Points targets = start;
    targets.bottomRows<1>() += shape.diagonal * mouse(++event);
    return milliseconds([&] { poser.move(targets); });
  };

  // Rounds of moves back to back, of bare factorizations, and of moves after pauses, so that all meet the
  // same noise. A worker may go on after a move: what follows one waits.
  std::vector<double> moves, one_substep, factors, solves, latencies;
  move();
  const int rounds = std::max(2, run.moves / 20), in_round = run.moves / rounds;
  double pause = 0.0;
  const auto rest = [&pause] {
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(pause));
  };
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < std::max(1, in_round / 4); ++i) {
      factors.push_back(milliseconds([&] { bare.factorize(); }));
      solves.push_back(milliseconds([&] { own.solve(); }));
    }
    pause = 2.5 * median(factors) + 1.0;
    move();  // finds its factor made
    for (int i = 0; i < in_round; ++i) {
      moves.push_back(move());
      if (poser.report().substeps == 1) one_substep.push_back(moves.back());
    }
    for (int i = 0; i < std::max(1, in_round / 5); ++i) {
      rest();
      latencies.push_back(move());
    }
    rest();
  }
  return {static_cast<int>(shape.vertices.rows()),
          median(moves),
          quantile(moves, 0.99),
          median(factors),
          median(latencies),
          quantile(latencies, 0.99),
          median(solves),
          median(one_substep)};
}

}  // namespace

void print_drags() {
  const std::vector<std::pair<const char*, PoserMethod>> methods{{"akvf", PoserMethod::akvf}};
  struct Size {
    int n, moves;
  };
  std::printf(
      "Moves along a mouse's path, ms: back to back (median, 99%%), of these the moves of one substep;\n"
      "after a pause (median, 99%%); one bare factorization and one solve in the same run\n\n"
      "%-7s%-8s%9s%9s%9s%9s%9s%9s%9s%9s%9s%9s%9s\n",
      "method", "shape", "vertices", "move", "99%", "bare", "ratio", "1 subst", "ratio", "paused", "99%",
      "solve", "solves");
  for (const auto& [name, kind] : methods) {
    double at_5k = 0.0, at_100k = 0.0;
    for (const auto& [shape, make] :
         {std::pair<const char*, Shape (*)(int)>{"square", square}, {"figure", figure}}) {
      for (const Size size : {Size{1000, 400}, {5000, 300}, {10000, 200}, {50000, 20}, {100000, 8}}) {
        if (make == figure && size.n > 50000) continue;
        const Result r = measure({name, kind, shape, make, size.n, size.moves});
        std::printf("%-7s%-8s%9d%9.2f%9.2f%9.2f%9.2f%9.2f%9.2f%9.2f%9.2f%9.2f%9.1f\n", name, shape,
                    r.vertices, r.move, r.slow_move, r.bare, r.move / r.bare, r.one_substep,
                    r.one_substep / r.bare, r.latency, r.slow_latency, r.solve, r.latency / r.solve);
        std::fflush(stdout);
        if (make == square && size.n == 5000) at_5k = r.move;
        if (make == square && size.n == 100000) at_100k = r.move;
      }
    }
    std::printf("%-7sa move grows from 5k to 100k vertices with exponent %.2f\n\n", name,
                std::log(at_100k / at_5k) / std::log(20.0));
  }
}

}  // namespace planar::benchmarks
