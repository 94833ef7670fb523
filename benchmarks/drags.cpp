// SPDX-License-Identifier: GPL-3.0-or-later
#include "drags.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "characters.h"
#include "planar/poser.h"
#include "shapes.h"
#include "systems.h"

namespace planar::benchmarks {

namespace {

constexpr double pi = 3.14159265358979323846;

struct Method {
  const char* name;
  PoserMethod kind;
};

/// Targets of successive events, and how many moves are to be timed back to back.
struct Drag {
  const char* name;
  Shape shape;
  std::vector<Points> targets;
  int moves;
};

struct Times {
  std::vector<double> moves, one_substep, paused, factors, solves;
};

/// Where a hand takes the dragged pin, as an offset in diagonals: round a loop of a tenth in 120 events, and
/// on; slow at four corners (0.1 to 0.7 % of the diagonal an event).
Eigen::RowVector2d mouse(int event) {
  const double time = event / 120.0;
  const double turn = 2.0 * pi * time + 0.2 * std::sin(8.0 * pi * time);
  return {0.1 * (std::cos(turn) - 1.0), 0.07 * std::sin(turn) + 0.02 * std::sin(2.0 * turn)};
}

Points pin_positions(const Shape& shape) {
  Points result(static_cast<Eigen::Index>(shape.pins.size()), 2);
  for (Eigen::Index i = 0; i < result.rows(); ++i)
    result.row(i) = shape.vertices.row(shape.pins[static_cast<std::size_t>(i)]);
  return result;
}

Drag mouse_drag(const char* name, Shape shape, int moves) {
  std::vector<Points> targets;
  for (int event = 0; event < 120; ++event) {
    targets.push_back(pin_positions(shape));
    targets.back().bottomRows<1>() += shape.diagonal * mouse(event);
  }
  return {name, std::move(shape), std::move(targets), moves};
}

/// A published pose of a character: all pins straight to their targets in 20 events, and back.
Drag pose_drag(const char* name, characters::Character character, std::size_t number) {
  const characters::Pose& pose = character.poses.at(number);
  const double diagonal = character.diagonal();
  Shape shape{std::move(character.vertices), std::move(character.triangles), pose.handles, diagonal};
  std::vector<Points> targets;
  for (int event = 0; event < 40; ++event) {
    const double share = 1.0 - std::abs(event - 20) / 20.0;
    targets.emplace_back(pose.start + share * (pose.targets - pose.start));
  }
  return {name, std::move(shape), std::move(targets), 100};
}

/// Rounds of moves back to back, of bare factorizations, and of moves after pauses, so that all meet the same
/// noise. A worker may go on after a move: what follows one waits.
Times measure(const Method& method, const Drag& drag) {
  OwnSystem own(drag.shape);
  BareSystem bare(own.matrix());
  Poser poser(drag.shape.vertices, drag.shape.triangles, {.method = method.kind});
  poser.set_handles(
      Handles::at_vertices(Eigen::Map<const Eigen::VectorXi>(
                               drag.shape.pins.data(), static_cast<Eigen::Index>(drag.shape.pins.size())),
                           drag.shape.vertices.rows()));
  std::size_t event = 0;
  const auto move = [&] {
    const Points& targets = drag.targets[++event % drag.targets.size()];
    return milliseconds([&] { poser.move(targets); });
  };
  Times times;
  const int rounds = std::max(2, drag.moves / 20), in_round = drag.moves / rounds;
  const auto rest = [&times] {
    std::this_thread::sleep_for(
        std::chrono::duration<double, std::milli>(1.5 * quantile(times.factors, 0.5) + 1.0));
  };
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < std::max(1, in_round / 5); ++i) {
      times.factors.push_back(milliseconds([&] { bare.factorize(); }));
      times.solves.push_back(milliseconds([&] { own.solve(); }));
    }
    move();  // the first one of a row finds its factor made, or has to make it
    for (int i = 0; i < in_round; ++i) {
      times.moves.push_back(move());
      if (poser.report().substeps == 1) times.one_substep.push_back(times.moves.back());
    }
    for (int i = 0; i < std::max(1, in_round / 5); ++i) {
      rest();
      times.paused.push_back(move());
    }
    rest();
  }
  return times;
}

/// \return the median move
double print_drag(const Method& method, const Drag& drag) {
  const Times times = measure(method, drag);
  const double move = quantile(times.moves, 0.5), bare = quantile(times.factors, 0.5);
  const double paused = quantile(times.paused, 0.5), solve = quantile(times.solves, 0.5);
  std::printf("%-6s%-10s%8d%9.2f%9.2f%9.2f%7.2f", method.name, drag.name,
              static_cast<int>(drag.shape.vertices.rows()), move, quantile(times.moves, 0.99), bare,
              move / bare);
  if (method.kind == PoserMethod::akvf) {
    std::printf("%10.2f", quantile(times.one_substep, 0.5) / bare);
  } else {
    std::printf("%10s", "-");
  }
  std::printf("%9.2f%9.2f%9.2f%8.1f\n", paused, quantile(times.paused, 0.99), solve, paused / solve);
  std::fflush(stdout);
  return move;
}

}  // namespace

void print_drags() {
  std::printf(
      "Moves along a mouse's path (square, figure) and along published poses, in ms, beside one bare\n"
      "factorization by CHOLMOD in the same run. move: back to back; 1 step: akvf's moves of one substep "
      "over\n"
      "bare; paused: the first move after a pause; solve: one of the library, for forces at two handles\n\n"
      "%-6s%-10s%8s%9s%9s%9s%7s%10s%9s%9s%9s%8s\n",
      "", "", "vertices", "move", "99%", "bare", "/bare", "1 step", "paused", "99%", "solve", "/solve");
  struct Size {
    int n, moves;
  };
  for (const Method& method : {Method{"hold", PoserMethod::hold}, Method{"akvf", PoserMethod::akvf}}) {
    double at_5k = 0.0, at_100k = 0.0;
    for (const Size& size : {Size{1000, 200}, {5000, 140}, {10000, 80}, {50000, 12}, {100000, 4}}) {
      const double move = print_drag(method, mouse_drag("square", square(size.n), size.moves));
      if (size.n == 5000) at_5k = move;
      if (size.n == 100000) at_100k = move;
    }
    for (const Size& size : {Size{1000, 200}, {5000, 140}, {10000, 80}, {50000, 12}}) {
      print_drag(method, mouse_drag("figure", figure(size.n), size.moves));
    }
    for (const char* name : {"elephant", "giraffe", "horse", "racoon"}) {
      if (auto character = characters::read(PLANAR_TEST_DATA, name)) {
        print_drag(method, pose_drag(name, std::move(*character), 0));
      }
    }
    std::printf("%-6sa move grows from 5k to 100k vertices of the square with exponent %.2f\n\n", method.name,
                std::log(at_100k / at_5k) / std::log(20.0));
  }
}

}  // namespace planar::benchmarks
