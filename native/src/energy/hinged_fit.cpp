// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/hinged_fit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr int most_steps = 30;
constexpr int closing_steps =
    4;  // after a step, to close the joints; what it left open is a square of its turn
constexpr int halving_budget = 6;     // of a step
constexpr double worthwhile = 1e-9;   // of the sum: what a step that is not the last one takes off
constexpr double largest_turn = 0.5;  // in a step, which takes turns as linear
constexpr double negligible = 1e-10;  // of the size: a step that is the last one

double sum_of(const std::vector<Return>& parts, const std::vector<Tie>& ties,
              const std::vector<RigidMotion>& motions) {
  double sum = 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Return& part = parts[p];
    // But for what no motion changes.
    sum += part.weight * (part.count * std::norm(motions[p].to - part.to) +
                          2.0 * (std::abs(part.turn) - std::real(std::conj(motions[p].turn) * part.turn)));
  }
  for (const Tie& tie : ties) {
    const Complex end = tie.other < 0 ? tie.to : motions[at(tie.other)].at(tie.to);
    sum += tie.weight * std::norm(motions[at(tie.part)].at(tie.from) - end);
  }
  return sum;
}

/// The normal equations of a step; unknowns of part p are 3p..3p+2: its way, and its turn times the size.
class Equations {
 public:
  Equations(std::size_t n_parts, double size) : right_(Eigen::VectorXd::Zero(at_row(n_parts))), size_(size) {}

  static Eigen::Index at_row(std::size_t part) { return 3 * static_cast<Eigen::Index>(part); }

  void add(std::size_t part, int unknown, double curvature, double slope) {
    const Eigen::Index row = at_row(part) + unknown;
    entries_.emplace_back(row, row, curvature);
    right_[row] -= slope;
  }

  /// What the curvature of the way that a turning point takes adds to that of a part's turn.
  void bend(std::size_t part, double curvature) {
    const Eigen::Index row = at_row(part) + 2;
    bends_.emplace_back(row, row, curvature / (size_ * size_));
  }

  /// A spring that is `left` long, as the turning points of one or two parts see it.
  void add(const Tie& tie, Complex left, Complex arm, Complex other_arm) {
    struct Column {
      Eigen::Index row;
      Complex way;
    };
    std::array<Column, 6> columns;
    std::size_t n = 0;
    const auto side = [&](int part, Complex from_middle, double sign) {
      const Eigen::Index row = at_row(at(part));
      columns[n++] = {row, sign};
      columns[n++] = {row + 1, Complex(0.0, sign)};
      columns[n++] = {row + 2, sign * Complex(0.0, 1.0) * from_middle / size_};
    };
    side(tie.part, arm, 1.0);
    bend(at(tie.part), -tie.weight * std::real(std::conj(left) * arm));
    if (tie.other >= 0) {
      side(tie.other, other_arm, -1.0);
      bend(at(tie.other), tie.weight * std::real(std::conj(left) * other_arm));
    }
    for (std::size_t i = 0; i < n; ++i) {
      right_[columns[i].row] -= tie.weight * std::real(std::conj(columns[i].way) * left);
      for (std::size_t j = 0; j < n; ++j) {
        if (columns[j].row > columns[i].row) continue;
        entries_.emplace_back(columns[i].row, columns[j].row,
                              tie.weight * std::real(std::conj(columns[i].way) * columns[j].way));
      }
    }
  }

  /// Newton's step where that leads down, else that of Gauss and Newton; empty if there is neither.
  Eigen::VectorXd solve(bool bent) const {
    if (!bent) return solution(entries_);
    std::vector<Eigen::Triplet<double>> all = entries_;
    all.insert(all.end(), bends_.begin(), bends_.end());
    Eigen::VectorXd step = solution(all);
    return step.size() != 0 ? step : solution(entries_);
  }

 private:
  Eigen::VectorXd solution(const std::vector<Eigen::Triplet<double>>& entries) const {
    Eigen::SparseMatrix<double> matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return {};
    Eigen::VectorXd step = factor.solve(right_);
    return step.allFinite() ? step : Eigen::VectorXd();
  }

  std::vector<Eigen::Triplet<double>> entries_, bends_;
  Eigen::VectorXd right_;
  double size_;
};

enum class Follow {
  all,   ///< ties and returns
  ties,  ///< with motions that are least as the returns weigh them
};

/// A step's way and turn (times the size) of each part; empty if there is none.
Eigen::VectorXd step_from(const std::vector<RigidMotion>& motions, const std::vector<Return>& parts,
                          const std::vector<Tie>& ties, double size, Follow follow) {
  Equations equations(parts.size(), size);
  const double pull = follow == Follow::all ? 1.0 : 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Return& part = parts[p];
    if (part.count == 0.0) {
      for (int unknown = 0; unknown < 3; ++unknown) equations.add(p, unknown, 1.0, 0.0);
      continue;
    }
    const double whole = part.weight * part.count;
    const Complex way = pull * whole * (motions[p].to - part.to);
    const Complex turn = std::conj(motions[p].turn) * part.turn;
    equations.add(p, 0, whole, way.real());
    equations.add(p, 1, whole, way.imag());
    equations.add(p, 2, part.weight * part.spread / (size * size), -pull * part.weight * turn.imag() / size);
    equations.bend(p, part.weight * (turn.real() - part.spread));
  }
  for (const Tie& tie : ties) {
    const RigidMotion& motion = motions[at(tie.part)];
    const Complex start = motion.at(tie.from);
    const RigidMotion* other = tie.other < 0 ? nullptr : &motions[at(tie.other)];
    const Complex end = other ? other->at(tie.to) : tie.to;
    equations.add(tie, start - end, start - motion.to, other ? end - other->to : Complex());
  }
  return equations.solve(follow == Follow::all);
}

void move(std::vector<RigidMotion>& motions, const Eigen::VectorXd& step, double share, double size) {
  for (std::size_t p = 0; p < motions.size(); ++p) {
    const Eigen::Index row = Equations::at_row(p);
    motions[p].to += share * Complex(step[row], step[row + 1]);
    motions[p].angle += share * step[row + 2] / size;
    motions[p].turn = std::polar(1.0, motions[p].angle);
  }
}

double largest_turn_of(const Eigen::VectorXd& step, double size) {
  double turn = 0.0;
  for (Eigen::Index row = 2; row < step.size(); row += 3) turn = std::max(turn, std::abs(step[row]) / size);
  return turn;
}

}  // namespace

std::vector<RigidMotion> fit_hinged_motions(const std::vector<Return>& parts, const std::vector<Tie>& ties,
                                            double size) {
  std::vector<RigidMotion> motions(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) motions[p].from = motions[p].to = parts[p].from;
  double sum = sum_of(parts, ties, motions);
  for (int i = 0; i < most_steps; ++i) {
    const Eigen::VectorXd step = step_from(motions, parts, ties, size, Follow::all);
    if (step.size() == 0 || step.cwiseAbs().maxCoeff() <= negligible * size) break;
    double share = std::min(1.0, largest_turn / largest_turn_of(step, size)), reached = sum;
    std::vector<RigidMotion> next;
    for (int halvings = 0; halvings <= halving_budget && !(reached < sum); ++halvings, share *= 0.5) {
      next = motions;
      move(next, step, share, size);
      // Turns open the joints, which are so stiff that hardly any would lessen the sum.
      for (int k = 0; k < closing_steps; ++k) {
        const Eigen::VectorXd back = step_from(next, parts, ties, size, Follow::ties);
        if (back.size() == 0 || largest_turn_of(back, size) > largest_turn) break;
        move(next, back, 1.0, size);
      }
      reached = sum_of(parts, ties, next);
    }
    if (!(reached < sum)) break;
    const bool enough = sum - reached < worthwhile * sum;
    motions = std::move(next);
    sum = reached;
    if (enough) break;
  }
  return motions;
}

}  // namespace planar
