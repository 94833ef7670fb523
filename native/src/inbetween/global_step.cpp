// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/global_step.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/complex_product.h"
#include "base/index.h"
#include "inbetween/edge_equations.h"
#include "linear/tridiagonal.h"

namespace planar {

using Complex = std::complex<double>;

namespace {

constexpr double sufficient = 1e-12;  // error to be left, of the solution
constexpr int most_steps = 1000;
constexpr Eigen::Index rows_per_task = 64;
constexpr Eigen::Index frames_per_task = 16;
constexpr Eigen::Index batches = 8;  // of tasks, between which a caller may cancel

double dot(const ComplexRows& a, const ComplexRows& b) {
  return (a.real() * b.real() + a.imag() * b.imag()).sum();
}

}  // namespace

GlobalStep::GlobalStep(const EdgeGraph& graph, ThreadTeam& team) : graph_(graph), team_(team), space_(graph) {
  space_.factorize(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(graph.edges.size())));
}

void GlobalStep::assemble(const ComplexRows& edges, ComplexRows& points,
                          const std::function<void(double)>& progress) {
  inner_ = edges.cols() - 2;
  const Eigen::Index padded = FrameAssembler::padded(inner_);
  double done = 0.0;
  const Tell tell = [&progress, &done] { progress(done); };
  set_equations(edges, tell);
  ComplexRows x = ComplexRows::Zero(graph_.n_vertices, padded), b = x, residual, z, direction, image;
  x.leftCols(inner_) = points.middleCols(1, inner_);
  for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
    const auto [from, to] = graph_.edges[i];
    b.row(from).head(inner_) -= right_.row(static_cast<Eigen::Index>(i));
    b.row(to).head(inner_) += right_.row(static_cast<Eigen::Index>(i));
  }
  multiply(x, image, tell);
  residual = b - image;
  precondition(residual, z, tell);
  direction = z;
  double error = dot(residual, z);  // squared, in the norm of P
  const double first_error = error;
  for (int step = 0; error > sufficient * sufficient * std::max(dot(x, b), 0.0); ++step) {
    if (step == most_steps) {
      throw SolveError("the global method finds no frames: some edges turn much faster than others");
    }
    done = std::clamp(std::log(error / first_error) / (2.0 * std::log(sufficient)), done, 1.0);
    multiply(direction, image, tell);
    const double length = error / dot(direction, image);
    x += length * direction;
    residual -= length * image;
    precondition(residual, z, tell);
    const double before = std::exchange(error, dot(residual, z));
    direction = z + (error / before) * direction;
  }
  points.middleCols(1, inner_) = x.leftCols(inner_);
}

/// Shares out tasks, a few for each thread at a time, and tells of it before each time: a cancel is obeyed
/// soon.
void GlobalStep::run(const Tell& tell, Eigen::Index count, const std::function<void(Eigen::Index)>& task) {
  const Eigen::Index batch = std::max<Eigen::Index>(team_.size(), count / batches);
  for (Eigen::Index first = 0; first < count; first += batch) {
    tell();
    team_.run(static_cast<std::size_t>(std::min(batch, count - first)),
              [&](std::size_t i, std::size_t) { task(first + static_cast<Eigen::Index>(i)); });
  }
}

/// Those of the edges, and of the parts by their means.
void GlobalStep::set_equations(const ComplexRows& edges, const Tell& tell) {
  const Eigen::Index n_edges = edges.rows();
  diagonal_.resize(n_edges, inner_);
  below_.resize(n_edges, inner_);
  right_.resize(n_edges, inner_);
  run(tell, (n_edges + rows_per_task - 1) / rows_per_task, [&](Eigen::Index task) {
    for (Eigen::Index i = task * rows_per_task; i < std::min((task + 1) * rows_per_task, n_edges); ++i) {
      edge_equations(edges.row(i), &diagonal_(i, 0), &below_(i, 0), &right_(i, 0));
    }
  });
  part_diagonal_ = Eigen::ArrayXXd::Zero(graph_.n_parts, inner_);
  part_below_ = ComplexRows::Zero(graph_.n_parts, inner_);
  Eigen::ArrayXd count = Eigen::ArrayXd::Zero(graph_.n_parts);
  for (Eigen::Index i = 0; i < n_edges; ++i) {
    const int part = graph_.part[at(graph_.edges[static_cast<std::size_t>(i)][0])];
    part_diagonal_.row(part) += diagonal_.row(i);
    part_below_.row(part) += below_.row(i);
    count[part] += 1.0;
  }
  part_diagonal_.colwise() /= count;
  part_below_.colwise() /= count.cast<Complex>();
}

/// image ← A x, some frames in a thread at a time.
void GlobalStep::multiply(const ComplexRows& x, ComplexRows& image, const Tell& tell) {
  image.setZero(x.rows(), x.cols());
  const Eigen::Index blocks = (inner_ + frames_per_task - 1) / frames_per_task;
  run(tell, blocks, [&](Eigen::Index block) {
    const Eigen::Index first = block * frames_per_task;
    const Eigen::Index end = std::min(first + frames_per_task, inner_);
    for (Eigen::Index i = 0; i < diagonal_.rows(); ++i) {
      const auto [from, to] = graph_.edges[static_cast<std::size_t>(i)];
      const auto e = [&x, from = from, to = to](Eigen::Index k) { return x(to, k) - x(from, k); };
      for (Eigen::Index k = first; k < end; ++k) {
        Complex sum = diagonal_(i, k) * e(k);
        if (k > 0) sum += product(below_(i, k - 1), e(k - 1));
        if (k + 1 < inner_) sum += product(std::conj(below_(i, k)), e(k + 1));
        image(from, k) -= sum;
        image(to, k) += sum;
      }
    }
  });
}

/// z ← P⁻¹ r: in time, then in space.
void GlobalStep::precondition(const ComplexRows& r, ComplexRows& z, const Tell& tell) {
  z.setZero(r.rows(), r.cols());
  const auto in_time = [&](Eigen::Index v) {
    const int part = graph_.part[static_cast<std::size_t>(v)];
    if (part == -1) return;
    const auto row = [this](const auto& of, Eigen::Index i) {
      const auto values = of.row(i).head(inner_);
      return std::vector<typename std::decay_t<decltype(of)>::Scalar>(values.begin(), values.end());
    };
    std::vector<double> diagonal = row(part_diagonal_, part);
    std::vector<Complex> x = row(r, v);
    solve_tridiagonal(diagonal, row(part_below_, part), x);
    std::copy(x.begin(), x.end(), &z(v, 0));
  };
  run(tell, (r.rows() + rows_per_task - 1) / rows_per_task, [&](Eigen::Index task) {
    for (Eigen::Index v = task * rows_per_task; v < std::min((task + 1) * rows_per_task, r.rows()); ++v) {
      in_time(v);
    }
  });
  run(tell, z.cols() / FrameAssembler::lanes,
      [&](Eigen::Index pass) { space_.assemble_sums(pass * FrameAssembler::lanes, z); });
}

}  // namespace planar
