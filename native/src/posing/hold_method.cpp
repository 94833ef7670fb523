// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/hold_method.h"

#include <algorithm>
#include <complex>
#include <limits>
#include <utility>

#include "base/complex_rows.h"
#include "base/diameter.h"
#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr int move_steps = 2;
constexpr int move_factors = 2;
constexpr int settle_budget = 200;       // steps, and factors
constexpr double tolerance = 1e-5;       // of the size
constexpr double negligible = 1e-8;      // of the size: a motion not worth making
constexpr double worth_following = 0.3;  // of the pins' energy: what a rigid motion may leave of it
constexpr int following_budget = 8;      // halvings of that motion
constexpr int worth_a_thread = 1000;     // vertices

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// \param rest n×2, or a RestOf
template <typename Rest>
Newton newton_at(const Rest& rest, const Mesh& mesh, const Springs& springs, const Orientation& orientation,
                 const Eigen::VectorXd& stiffness, double size) {
  Newton newton(mesh, springs, stiffness, orientation, size);
  newton.set_energy(RestEnergy(rest, newton.system().matrix(), orientation.flat(), stiffness), 1.0);
  return newton;
}

/// How often the triangles at each vertex go round it, n, counted where they cross the x direction; those
/// that lie the other way round count less.
Eigen::VectorXi windings_of(const Points& x, const Triangles& triangles) {
  Eigen::VectorXi windings = Eigen::VectorXi::Zero(x.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int v = triangles(t, corner);
      const Eigen::RowVector2d next = x.row(triangles(t, (corner + 1) % 3)) - x.row(v);
      const Eigen::RowVector2d last = x.row(triangles(t, (corner + 2) % 3)) - x.row(v);
      const bool below = next.y() <= 0.0;
      if (below == (last.y() <= 0.0)) continue;
      const double turn = next.x() * last.y() - next.y() * last.x();
      if (below ? turn > 0.0 : turn < 0.0) windings[v] += below ? 1 : -1;
    }
  }
  return windings;
}

}  // namespace

double HoldMethod::PinSprings::value(const Points& x, Points* gradient) const {
  double sum = 0.0;
  for (const Pin& pin : pins) {
    const Eigen::RowVector2d left = pinned_point(pin, x) - pin.position;
    sum += pin.strength * left.squaredNorm();
    if (gradient == nullptr) continue;
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      gradient->row(pin.vertex[c]) += 2.0 * pin.strength * pin.weight[c] * left;
    }
  }
  for (const LineSpring& line : lines) {
    const double left = line.normal.dot(x.row(line.vertex)) - line.offset;
    sum += line.strength * left * left;
    if (gradient != nullptr) gradient->row(line.vertex) += 2.0 * line.strength * left * line.normal;
  }
  return sum;
}

void HoldMethod::PinSprings::add_hessian(MeshMatrix& matrix, double scale) const {
  for (const Pin& pin : pins) {
    for (std::size_t a = 0; a < pin.n_corners; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        matrix.add(pin.vertex[a], pin.vertex[b], 2.0 * scale * pin.strength * pin.weight[a] * pin.weight[b]);
      }
    }
  }
  for (const LineSpring& line : lines) {
    matrix.add(line.vertex, 2.0 * scale * line.strength * line.normal.transpose() * line.normal);
  }
}

HoldMethod::HoldMethod(const Points& rest, const Triangles& triangles, const Orientation& orientation,
                       const Eigen::VectorXd& stiffness)
    : mesh_(rest.rows(), triangles),
      orientation_(orientation),
      rest_(rest),
      windings_at_rest_(windings_of(rest, triangles)),
      newton_(newton_at(rest, mesh_, springs_, orientation, stiffness, diameter(rest))) {}

HoldMethod::HoldMethod(Mesh mesh, const RestOf& rest_of, const Orientation& orientation, double size)
    : mesh_(std::move(mesh)),
      orientation_(orientation),
      free_(true),
      newton_(newton_at(rest_of, mesh_, springs_, orientation, {}, size)) {}

void HoldMethod::set_handles(const HandleSet& set) {
  std::vector<Pin> pins = make_pins(mesh_, set.handles, set.strength, set.patch);
  std::vector<char> active(at(mesh_.n_parts), free_);
  for (const Pin& pin : pins) active[at(pin.part)] = 1;
  worker_.wait();
  newton_.system().set_active(std::move(active));
  springs_.pins = std::move(pins);
  springs_.lines.clear();
}

void HoldMethod::set_lines(std::vector<LineSpring> lines) {
  reset();
  springs_.lines = std::move(lines);
}

void HoldMethod::set_rest(const Points& rest) {
  reset();
  unseen_ = may_be_tangled_ = false;
  rest_ = rest;
  windings_at_rest_ = windings_of(rest, mesh_.triangles);
  newton_.set_energy(RestEnergy(rest, newton_.system().matrix(), orientation_.flat(), {}), 1.0);
}

void HoldMethod::reset() noexcept {
  worker_.wait();
  newton_.system().forget();
  unseen_ = true;
}

/// A bounded piece of work, after which the next factor is made while the caller goes on.
Newton::Budget HoldMethod::two_steps(double limit) const {
  return {move_steps, move_factors, true, limit, tolerance * newton_.size()};
}

void HoldMethod::move(const Points& targets, Points& x, Report& report) {
  descend(targets, two_steps(unlimited), x, report);
}

void HoldMethod::refine(const Points& targets, Points& x, Report& report) {
  descend(targets, two_steps(refine_limit * newton_.size()), x, report);
}

void HoldMethod::settle(const Points& targets, Points& x, Report& report) {
  settle_within(settle_budget, {}, targets, x, report);
}

void HoldMethod::settle_within(int steps, const std::function<void()>& before_step, const Points& targets,
                               Points& x, Report& report) {
  descend(targets, {steps, steps, false, unlimited, tolerance * newton_.size(), before_step}, x, report);
}

void HoldMethod::descend(const Points& targets, const Newton::Budget& budget, Points& x, Report& report) {
  report.converged = springs_.pins.empty() && !free_;
  if (report.converged) return;
  worker_.wait();
  for (Pin& pin : springs_.pins) {
    pin.position.setZero();
    for (const int row : pin.rows) pin.position += targets.row(row) / static_cast<double>(pin.rows.size());
  }
  if (unseen_ && rest_.rows() != 0) {
    begin_from_rest(knotted(x), x);
    may_be_tangled_ = orientation_.count_flipped(x) > 0;
  }
  unseen_ = false;
  try {
    descend_from(budget, x, report);
    if (may_be_tangled_ && (report.converged || !budget.ahead)) {
      if (begin_from_rest(tangled(x), x)) descend_from(budget, x, report);
      may_be_tangled_ = false;
    }
  } catch (...) {
    newton_.system().forget();
    throw;
  }
  if (!budget.ahead || report.converged || !newton_.due()) return;
  ahead_ = x;
  const auto task = [this] { newton_.renew_ahead(ahead_); };
  if (mesh_.n_vertices >= worth_a_thread) {
    worker_.start(task);
  } else {
    task();
  }
}

void HoldMethod::descend_from(const Newton::Budget& budget, Points& x, Report& report) {
  newton_.begin(x);
  const bool underway = follow_rigidly(budget.limit, x);
  const Newton::Outcome outcome = newton_.descend(budget, x);
  report.iterations += outcome.iterations;
  report.substeps += outcome.steps;
  report.converged = outcome.converged && !underway;
}

/// Flags of the parts that go round one of their inner vertices more often than at rest. Descents keep that
/// as it is: no triangle needs to be turned over there, and none may be on the way out.
std::vector<char> HoldMethod::knotted(const Points& x) const {
  std::vector<char> result(at(mesh_.n_parts));
  const Eigen::VectorXi windings = windings_of(x, mesh_.triangles);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (mesh_.interior[at(v)] && std::abs(windings[v]) > std::abs(windings_at_rest_[v])) {
      result[at(mesh_.part[at(v)])] = 1;
    }
  }
  return result;
}

/// Flags of the parts that are knotted or have triangles that lie the other way round than at rest.
std::vector<char> HoldMethod::tangled(const Points& x) const {
  std::vector<char> result = knotted(x);
  const Flags flipped = orientation_.flipped(x);
  for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
    if (flipped[at(t)]) result[at(mesh_.part[at(mesh_.triangles(t, 0))])] = 1;
  }
  return result;
}

/// Of each pin, from where it is at x to its target.
std::vector<PointPair> HoldMethod::ways_from(const Points& x) const {
  std::vector<PointPair> pairs;
  pairs.reserve(springs_.pins.size());
  for (const Pin& pin : springs_.pins) {
    pairs.push_back(
        {pin.part, pin.strength, complex_point(pinned_point(pin, x)), complex_point(pin.position)});
  }
  return pairs;
}

/// Puts parts to where the rest shape comes nearest to the targets of their pins; false if there are none.
bool HoldMethod::begin_from_rest(const std::vector<char>& parts, Points& x) {
  const auto is_held = [&parts](const Pin& pin) { return parts[at(pin.part)] != 0; };
  if (std::none_of(springs_.pins.begin(), springs_.pins.end(), is_held)) return false;
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, ways_from(rest_));
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int part = mesh_.part[at(v)];
    if (part < 0 || !parts[at(part)] || !newton_.system().is_active(v)) continue;
    const Complex p = motions[at(part)].at(complex_row(rest_, v));
    x.row(v) << p.real(), p.imag();
  }
  newton_.system().forget();
  return true;
}

/// Takes the parts along with their pins where that is a rigid motion for the most part, no vertex further
/// than `limit`; true if the limit stopped it.
bool HoldMethod::follow_rigidly(double limit, Points& x) {
  if (!springs_.lines.empty()) return false;
  const std::vector<PointPair> pairs = ways_from(x);
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, pairs);
  // Σ strength |pin - its target|² of each part without and with its motion.
  std::vector<double> before(motions.size()), after(motions.size());
  for (const PointPair& pair : pairs) {
    before[at(pair.part)] += pair.weight * std::norm(pair.to - pair.from);
    after[at(pair.part)] += pair.weight * std::norm(pair.to - motions[at(pair.part)].at(pair.from, 1.0));
  }
  const auto follows = [&](std::size_t part) {
    return before[part] > 0.0 && after[part] <= worth_following * before[part];
  };
  double furthest = 0.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!newton_.system().is_active(v) || !follows(at(mesh_.part[at(v)]))) continue;
    const RigidMotion& motion = motions[at(mesh_.part[at(v)])];
    furthest = std::max(furthest, std::abs(motion.to - motion.from) +
                                      std::abs(motion.angle) * std::abs(complex_row(x, v) - motion.from));
  }
  if (furthest <= negligible * newton_.size()) return false;
  double share = furthest > limit ? limit / furthest : 1.0;
  for (int halvings = 0; halvings <= following_budget; ++halvings, share *= 0.5) {
    trial_ = x;
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (!newton_.system().is_active(v) || !follows(at(mesh_.part[at(v)]))) continue;
      const Complex p = motions[at(mesh_.part[at(v)])].at(complex_row(x, v), share);
      trial_.row(v) << p.real(), p.imag();
    }
    if (!newton_.keeps_upright(trial_)) continue;
    std::vector<Complex> turn(motions.size(), 1.0);
    for (std::size_t part = 0; part < motions.size(); ++part) {
      if (follows(part)) turn[part] = std::polar(1.0, share * motions[part].angle);
    }
    newton_.system().turn(turn);
    std::swap(x, trial_);
    return share < 1.0;
  }
  return false;
}

}  // namespace planar
