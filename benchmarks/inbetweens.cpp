// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetweens.h"

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <complex>
#include <cstdio>
#include <fstream>
#include <limits>
#include <numbers>

#include "inbetween/edge_turns.h"
#include "mesh/mesh.h"
#include "planar/distortion.h"
#include "planar/inbetween.h"
#include "planar/poser.h"
#include "shapes.h"
#include "systems.h"

namespace planar::benchmarks {
namespace {

using Complex = std::complex<double>;

/// The drawn figure about its rest: arms raised by 70 degrees, a step forward.
std::vector<Points> keys_of(const Shape& shape) {
  const Handles handles = Handles::at_vertices(
      Eigen::Map<const Eigen::VectorXi>(shape.pins.data(), static_cast<Eigen::Index>(shape.pins.size())),
      shape.vertices.rows());
  Points targets = handles.positions(shape.vertices);
  const auto turn = [&targets](Eigen::Index pin, Complex centre, double degrees) {
    const Complex p = centre + std::polar(1.0, degrees * std::numbers::pi / 180.0) *
                                   (Complex(targets(pin, 0), targets(pin, 1)) - centre);
    targets.row(pin) << p.real(), p.imag();
  };
  turn(2, {-0.55, 0.0}, -30.0);
  turn(3, {0.55, 0.0}, 35.0);
  turn(4, {-1.0, 3.5}, -70.0);
  turn(5, {1.0, 3.5}, 70.0);
  Poser poser(shape.vertices, shape.triangles);
  poser.set_handles(handles);
  poser.move(targets);
  return {shape.vertices, poser.settle()};
}

Eigen::VectorXd uniform(int frames) { return Eigen::VectorXd::LinSpaced(frames, 0.0, 1.0); }

/// The least of several runs, in seconds: the machine's noise only ever adds.
double seconds(int runs, auto&& call) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) least = std::min(least, milliseconds(call) / 1e3);
  return least;
}

/// One pass of (9) over some of the edges by dense algebra, what a plain reading of the paper costs.
double dense_seconds(int frames, std::size_t n_edges) {
  constexpr int sample = 4;
  const double pass = seconds(1, [frames] {
    for (int edge = 0; edge < sample; ++edge) {
      Eigen::MatrixXcd rows = Eigen::MatrixXcd::Zero(2 * (frames - 1), frames - 2);
      for (int k = 0; k + 1 < frames; ++k) {
        for (int column : {k - 1, k}) {
          if (column < 0 || column >= frames - 2) continue;
          rows(2 * k, column) = column == k ? Complex(1.0) : Complex(-1.0, -0.01 * edge);
          rows(2 * k + 1, column) = column == k ? Complex(1.0, -0.01 * edge) : Complex(-1.0);
        }
      }
      const Eigen::MatrixXcd normal = rows.adjoint() * rows;
      const Eigen::VectorXcd x = normal.ldlt().solve(Eigen::VectorXcd::Ones(frames - 2));
      if (!x.allFinite()) std::puts("overflow");
    }
  });
  return pass / sample * static_cast<double>(n_edges);
}

/// The peer: per triangle the rotation of the polar decomposition, unwrapped, and its stretch are blended,
/// then one Poisson solve (two right sides) with the first key's areas places the vertices.
std::vector<Points> polar_blend(const std::vector<Points>& keys, const Shape& shape,
                                const Eigen::VectorXd& times) {
  const EdgeGraph graph(shape.vertices.rows(), shape.triangles);
  const Eigen::VectorXd edge_turns = EdgeTurns(graph).between(keys[0], keys[1]);
  const auto m = static_cast<std::size_t>(shape.triangles.rows());
  const int n = static_cast<int>(shape.vertices.rows());
  struct Triangle {
    Eigen::Matrix<double, 3, 2> gradient;  // of the hat functions
    double area, turn;
    Eigen::Matrix2d stretch;
  };
  std::vector<Triangle> triangles(m);
  const auto turn_of = [&](int a, int b) {
    const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
    const auto place = std::lower_bound(graph.edges.begin(), graph.edges.end(), edge) - graph.edges.begin();
    return edge_turns[place];
  };
  for (std::size_t t = 0; t < m; ++t) {
    const auto corner = shape.triangles.row(static_cast<Eigen::Index>(t));
    Eigen::Matrix2d from, to;
    for (int c = 0; c < 2; ++c) {
      from.col(c) = (keys[0].row(corner[c + 1]) - keys[0].row(corner[0])).transpose();
      to.col(c) = (keys[1].row(corner[c + 1]) - keys[1].row(corner[0])).transpose();
    }
    const Eigen::Matrix2d inverse = from.inverse(), jacobian = to * inverse;
    Triangle& triangle = triangles[t];
    triangle.area = 0.5 * std::abs(from.determinant());
    triangle.gradient.row(1) = inverse.row(0);
    triangle.gradient.row(2) = inverse.row(1);
    triangle.gradient.row(0) = -inverse.row(0) - inverse.row(1);
    const double angle = std::atan2(jacobian(1, 0) - jacobian(0, 1), jacobian(0, 0) + jacobian(1, 1));
    const double near =
        (turn_of(corner[0], corner[1]) + turn_of(corner[1], corner[2]) + turn_of(corner[2], corner[0])) / 3.0;
    triangle.turn = near + wrapped(angle - near);
    triangle.stretch = Eigen::Rotation2Dd(-angle).toRotationMatrix() * jacobian;
  }
  const auto solver = SparseSolver::create(default_backend());
  SymmetricMatrix matrix;
  matrix.size = n;
  const auto assemble = [&](const std::vector<int>& place) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t t = 0; t < m; ++t) {
      const Eigen::Matrix3d local =
          triangles[t].area * triangles[t].gradient * triangles[t].gradient.transpose();
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          const int row = place[static_cast<std::size_t>(shape.triangles(static_cast<Eigen::Index>(t), a))],
                    column =
                        place[static_cast<std::size_t>(shape.triangles(static_cast<Eigen::Index>(t), b))];
          if (row >= column) entries.emplace_back(row, column, local(a, b));
        }
      }
    }
    entries.emplace_back(place[0], place[0], 1.0);
    Eigen::SparseMatrix<double> sparse(n, n);
    sparse.setFromTriplets(entries.begin(), entries.end());
    matrix.column_start.assign(sparse.outerIndexPtr(), sparse.outerIndexPtr() + n + 1);
    matrix.row.assign(sparse.innerIndexPtr(), sparse.innerIndexPtr() + sparse.nonZeros());
    matrix.value.assign(sparse.valuePtr(), sparse.valuePtr() + sparse.nonZeros());
  };
  std::vector<int> place(static_cast<std::size_t>(n));
  for (int v = 0; v < n; ++v) place[static_cast<std::size_t>(v)] = v;
  assemble(place);
  const std::vector<int> order = solver->fill_reducing_order(matrix);
  for (int k = 0; k < n; ++k) place[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])] = k;
  assemble(place);
  solver->analyze(matrix);
  solver->factorize(matrix);
  std::vector<Points> frames;
  for (const double t : times) {
    Points right = Points::Zero(n, 2), frame(n, 2);
    for (std::size_t i = 0; i < m; ++i) {
      const Triangle& triangle = triangles[i];
      const Eigen::Matrix2d jacobian = Eigen::Rotation2Dd(t * triangle.turn).toRotationMatrix() *
                                       ((1.0 - t) * Eigen::Matrix2d::Identity() + t * triangle.stretch);
      const Eigen::Matrix<double, 3, 2> pull = triangle.area * triangle.gradient * jacobian.transpose();
      for (int c = 0; c < 3; ++c) {
        right.row(place[static_cast<std::size_t>(shape.triangles(static_cast<Eigen::Index>(i), c))]) +=
            pull.row(c);
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::VectorXd x = right.col(axis);
      solver->solve(x, x);
      for (int v = 0; v < n; ++v) frame(v, axis) = x[place[static_cast<std::size_t>(v)]];
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// What the process holds in memory, in MB; 0 where /proc does not tell.
double resident() {
  long pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident_pages;
  return static_cast<double>(resident_pages) * 4096.0 / 1e6;
}

void print_paper_sizes() {
  std::printf(
      "\n205 frames, seconds (the paper's on a Core i5 at 2.8 GHz; dense: one pass of (9), from 4 edges)\n");
  std::printf("%9s %7s %9s %12s %13s %14s %9s\n", "vertices", "paper's", "midpoint", "method paper",
              "method global", "dense (9)", "");
  // The least sizes of the figure that are not below the paper's 272 and 467 vertices.
  const std::vector<std::pair<int, double>> cases{{200, 2.324}, {380, 4.118}};
  for (const auto& [n, published] : cases) {
    const Shape shape = figure(n);
    const std::vector<Points> keys = keys_of(shape);
    InbetweenOptions paper;
    paper.method = InbetweenMethod::paper;
    const double midpoint = seconds(5, [&] { (void)inbetween(keys, uniform(205), shape.triangles); });
    const double local = seconds(3, [&] { (void)inbetween(keys, uniform(205), shape.triangles, paper); });
    paper.method = InbetweenMethod::global;
    const double global = seconds(1, [&] { (void)inbetween(keys, uniform(205), shape.triangles, paper); });
    const Mesh mesh(shape.vertices.rows(), shape.triangles);
    std::printf("%9td %7.3f %9.4f %12.4f %13.4f %14.1f   1/%.0f, 1/%.0f of the paper's\n",
                shape.vertices.rows(), published, midpoint, local, global,
                dense_seconds(205, mesh.edges.size()), published / midpoint, published / local);
  }
}

void print_peer() {
  std::printf("\n24 frames, milliseconds, beside the polar blend with one Poisson solve a frame\n");
  std::printf("%9s %9s %9s %6s   worst frame, area and angle: keys, midpoint, blend\n", "vertices",
              "midpoint", "blend", "ratio");
  for (const int n : {1000, 5000, 20000}) {
    const Shape shape = figure(n);
    const std::vector<Points> keys = keys_of(shape);
    const Eigen::VectorXd times = uniform(26).segment(1, 24);
    std::vector<Points> frames, blended;
    const double own = seconds(5, [&] { frames = inbetween(keys, times, shape.triangles); });
    const double peer = seconds(5, [&] { blended = polar_blend(keys, shape, times); });
    const auto worst = [&](const std::vector<Points>& of) {
      std::array<double, 2> result{};
      for (const Points& frame : of) {
        const Distortion d = distortion(shape.vertices, frame, shape.triangles);
        result = {std::max(result[0], d.area), std::max(result[1], d.angle)};
      }
      return result;
    };
    const auto ends = worst(keys), mine = worst(frames), theirs = worst(blended);
    std::printf("%9td %9.2f %9.2f %6.2f   %.4f %.4f, %.4f %.4f, %.4f %.4f\n", shape.vertices.rows(),
                1e3 * own, 1e3 * peer, own / peer, ends[0], ends[1], mine[0], mine[1], theirs[0], theirs[1]);
  }
}

/// Head and hip stand, a foot goes straight.
void print_pins() {
  std::printf("\n24 frames, milliseconds a frame, without pins and with three\n%9s %9s %9s\n", "vertices",
              "without", "with");
  for (const int n : {1000, 5000, 10000}) {
    const Shape shape = figure(n);
    const std::vector<Points> keys = keys_of(shape);
    const Eigen::VectorXd times = uniform(26).segment(1, 24);
    InbetweenOptions pinned;
    pinned.pins =
        Handles::at_vertices(Eigen::Map<const Eigen::VectorXi>(shape.pins.data(), 3), shape.vertices.rows());
    const double without = seconds(5, [&] { (void)inbetween(keys, times, shape.triangles); });
    const double with = seconds(5, [&] { (void)inbetween(keys, times, shape.triangles, pinned); });
    std::printf("%9td %9.2f %9.2f\n", shape.vertices.rows(), 1e3 * without / 24.0, 1e3 * with / 24.0);
  }
}

void print_long_shot() {
  const Shape shape = figure(5000);
  const std::vector<Points> keys = keys_of(shape);
  std::vector<Points> frames;
  const double time = seconds(1, [&] { frames = inbetween(keys, uniform(1000), shape.triangles); });
  std::printf(
      "\n1000 frames of %td vertices: %.2f s; the process holds %.0f MB, %.0f MB of them the frames\n",
      shape.vertices.rows(), time, resident(),
      1000.0 * static_cast<double>(shape.vertices.rows()) * 16.0 / 1e6);
}

}  // namespace

void print_inbetweens() {
  print_paper_sizes();
  print_peer();
  print_pins();
  print_long_shot();
}

}  // namespace planar::benchmarks
