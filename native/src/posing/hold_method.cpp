// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/hold_method.h"

#include <algorithm>
#include <complex>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "base/checks.h"
#include "base/complex_rows.h"
#include "base/diameter.h"
#include "base/disjoint_sets.h"
#include "base/index.h"

namespace planar {

namespace {

using Complex = std::complex<double>;

constexpr int move_steps = 2;
constexpr int move_factors = 2;
constexpr int settle_budget = 200;       // steps, and factors
constexpr int advance_steps = 3;         // and factors: as many as one serves
constexpr double tolerance = 1e-5;       // of the size
constexpr double negligible = 1e-8;      // of the size: a motion not worth making
constexpr double worth_following = 0.3;  // of the pins' energy: what a rigid motion may leave of it
constexpr int following_budget = 8;      // halvings of that motion
constexpr double worth_a_factor = 0.01;  // radians between parts on a joint
constexpr int steps_between_turns = 20;  // of a settle with joints
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

std::vector<int> each_alone(int n_parts) {
  std::vector<int> group(at(n_parts));
  std::iota(group.begin(), group.end(), 0);
  return group;
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

HoldMethod::HoldMethod(const Points& rest, const Triangles& triangles, const Orientation& orientation,
                       const Eigen::VectorXd& stiffness)
    : mesh_(rest.rows(), triangles),
      orientation_(orientation),
      rest_(rest),
      windings_at_rest_(windings_of(rest, triangles)),
      group_(each_alone(mesh_.n_parts)),
      newton_(newton_at(rest, mesh_, springs_, orientation, stiffness, diameter(rest))) {}

HoldMethod::HoldMethod(Mesh mesh, const RestOf& rest_of, const Orientation& orientation, double size)
    : mesh_(std::move(mesh)),
      orientation_(orientation),
      free_(true),
      group_(each_alone(mesh_.n_parts)),
      newton_(newton_at(rest_of, mesh_, springs_, orientation, {}, size)) {}

void HoldMethod::set_handles(const HandleSet& set) {
  std::vector<Pin> pins = make_pins(mesh_, set.handles, set.strength, set.patch);
  worker_.wait();
  springs_.pins = std::move(pins);
  springs_.lines.clear();
  set_active();
}

void HoldMethod::set_joints(const JointSet& set) {
  std::vector<Joint> joints;
  std::vector<std::array<int, 2>> links;
  DisjointSets together(at(mesh_.n_parts));
  for (int row = 0; row < static_cast<int>(set.first.size()); ++row) {
    const Joint joint{point_of(mesh_, set.first, row, "first"), point_of(mesh_, set.second, row, "second"),
                      set.strength[row]};
    for (const auto& [pin, name] : {std::pair{&joint.first, "first"}, std::pair{&joint.second, "second"}}) {
      if (pin->part < 0) throw std::invalid_argument(row_of(name, row) + "its vertex is one of no triangle");
    }
    if (joint.first.part == joint.second.part) {
      throw std::invalid_argument(row_of("second", row) + "on the same part as the first point");
    }
    together.join(joint.first.part, joint.second.part);
    for (std::size_t a = 0; a < joint.first.n_corners; ++a) {
      for (std::size_t b = 0; b < joint.second.n_corners; ++b) {
        links.push_back({joint.first.vertex[a], joint.second.vertex[b]});
      }
    }
    joints.push_back(joint);
  }
  worker_.wait();
  newton_.system().link(links);
  newton_.set_energy(
      RestEnergy(rest_, newton_.system().matrix(), orientation_.flat(), newton_.system().stiffness()), 1.0);
  joints_ = std::move(joints);
  for (int part = 0; part < mesh_.n_parts; ++part) group_[at(part)] = together.find(part);
  set_active();
}

/// The parts with pins, and what hangs together with them, move.
void HoldMethod::set_active() {
  std::vector<char> moves(at(mesh_.n_parts), free_), hangs(at(mesh_.n_parts)), active(at(mesh_.n_parts));
  for (const Pin& pin : springs_.pins) moves[at(group_[at(pin.part)])] = 1;
  for (std::size_t part = 0; part < active.size(); ++part) active[part] = moves[at(group_[part])];
  springs_.joints.clear();
  for (const Joint& joint : joints_) {
    const int group = group_[at(joint.first.part)];
    if (!moves[at(group)]) continue;
    hangs[at(group)] = 1;
    springs_.joints.push_back(joint);
  }
  springs_.hanging.clear();
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (mesh_.part[at(v)] >= 0 && hangs[at(group_[at(mesh_.part[at(v)])])]) springs_.hanging.push_back(v);
  }
  newton_.system().set_active(std::move(active));
  origin_.resize(0, 2);
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
  newton_.forget();
  unseen_ = true;
  origin_.resize(0, 2);
}

void HoldMethod::go_on() noexcept {
  reset();
  unseen_ = may_be_tangled_ = false;
}

bool HoldMethod::is_knotted(const Points& x) const {
  const std::vector<char> parts = knotted(x);
  return std::find(parts.begin(), parts.end(), char{1}) != parts.end();
}

/// A bounded piece of work, after which the next factor is made while the caller goes on.
Newton::Budget HoldMethod::two_steps(double limit) const {
  return {move_steps, move_factors, true, limit, tolerance * newton_.size()};
}

void HoldMethod::move(const Points& targets, Points& x, Report& report) {
  descend(targets, two_steps(unlimited), false, x, report);
}

void HoldMethod::refine(const Points& targets, Points& x, Report& report) {
  descend(targets, two_steps(refine_limit * newton_.size()), false, x, report);
}

void HoldMethod::advance(const Points& targets, Points& x, Report& report) {
  const double limit = refine_limit * newton_.size();
  descend(targets, {advance_steps, advance_steps, false, limit, tolerance * newton_.size()}, false, x,
          report);
}

void HoldMethod::settle(const Points& targets, Points& x, Report& report) {
  settle_within(settle_budget, {}, targets, x, report);
}

void HoldMethod::settle_within(int steps, const std::function<void()>& before_step, const Points& targets,
                               Points& x, Report& report) {
  descend(targets, {steps, steps, false, unlimited, tolerance * newton_.size(), before_step}, true, x,
          report);
}

void HoldMethod::descend(const Points& targets, const Newton::Budget& budget, bool ends, Points& x,
                         Report& report) {
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
  if (!springs_.hanging.empty()) set_reference(x);
  try {
    descend_from(budget, x, report);
    if (may_be_tangled_ && (report.converged || ends)) {
      if (begin_from_rest(tangled(x), x)) descend_from(budget, x, report);
      may_be_tangled_ = false;
    }
  } catch (...) {
    newton_.forget();
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
  if (!springs_.joints.empty()) start_ = x;
  bool underway = follow_rigidly(budget.limit, x);
  Newton::Budget left = budget;
  do {
    Newton::Budget next = left;
    if (!springs_.joints.empty()) {
      const double room = budget.limit - (x - start_).rowwise().norm().maxCoeff();
      if (!underway) underway = turn_on_joints(room, x);
      next.steps = std::min(left.steps, steps_between_turns);
    }
    const Newton::Outcome outcome = newton_.descend(next, x);
    report.iterations += outcome.iterations;
    report.substeps += outcome.steps;
    report.converged = outcome.converged && !underway;
    left.steps -= next.steps;
  } while (!report.converged && left.steps > 0);
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
    pairs.push_back({group_[at(pin.part)], pin.strength, complex_point(pinned_point(pin, x)),
                     complex_point(pin.position)});
  }
  return pairs;
}

/// Puts parts to where the rest shape comes nearest to the targets of their pins; false if there are none.
bool HoldMethod::begin_from_rest(const std::vector<char>& parts, Points& x) {
  std::vector<char> wanted(parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (parts[part]) wanted[at(group_[part])] = 1;
  }
  const auto is_held = [&](const Pin& pin) { return wanted[at(group_[at(pin.part)])] != 0; };
  if (std::none_of(springs_.pins.begin(), springs_.pins.end(), is_held)) return false;
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, ways_from(rest_));
  const auto motion_of = [&](int part) -> const RigidMotion& { return motions[at(group_[at(part)])]; };
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int part = mesh_.part[at(v)];
    if (part < 0 || !parts[at(part)] || !newton_.system().is_active(v)) continue;
    const Complex p = motion_of(part).at(complex_row(rest_, v));
    x.row(v) << p.real(), p.imag();
  }
  newton_.forget();
  return true;
}

/// Where hanging vertices would be, as their pins are to go, if all that hangs together moved as one from
/// where it was at first.
void HoldMethod::set_reference(const Points& x) {
  if (origin_.rows() == 0) origin_ = x;
  const std::vector<RigidMotion> motions = fit_rigid_motions(mesh_.n_parts, ways_from(origin_));
  springs_.reference.resize(x.rows(), 2);
  for (const int v : springs_.hanging) {
    const Complex p = motions[at(group_[at(mesh_.part[at(v)])])].at(complex_row(origin_, v));
    springs_.reference.row(v) << p.real(), p.imag();
  }
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
  const auto follows = [&](std::size_t group) {
    return before[group] > 0.0 && after[group] <= worth_following * before[group];
  };
  std::vector<char> moves(at(mesh_.n_parts));
  std::vector<RigidMotion> by_part(moves.size());
  for (std::size_t part = 0; part < moves.size(); ++part) {
    moves[part] = follows(at(group_[part]));
    by_part[part] = motions[at(group_[part])];
  }
  return move_rigidly(by_part, moves, limit, x);
}

/// Turns parts on their joints to where all springs are shortest, no vertex further than `limit`; true if the
/// limit stopped it. Newton steps, being linear, go a short way at once where parts turn freely.
bool HoldMethod::turn_on_joints(double limit, Points& x) {
  std::vector<char> moves(at(mesh_.n_parts));
  std::vector<Return> returns(moves.size());
  const auto for_hanging = [&](const auto& visit) {
    for (const int v : springs_.hanging) {
      visit(returns[at(mesh_.part[at(v)])], complex_row(x, v), complex_row(springs_.reference, v));
    }
  };
  for (const int v : springs_.hanging) moves[at(mesh_.part[at(v)])] = 1;
  for_hanging([](Return& part, Complex p, Complex q) {
    part.weight = HoldSprings::return_strength;
    part.count += 1.0;
    part.from += p;
    part.to += q;
  });
  for (Return& part : returns) {
    if (part.count == 0.0) continue;
    part.from /= part.count;
    part.to /= part.count;
  }
  for_hanging([](Return& part, Complex p, Complex q) {
    part.spread += std::norm(p - part.from);
    part.turn += std::conj(p - part.from) * (q - part.to);
  });
  std::vector<Tie> ties;
  for (const Pin& pin : springs_.pins) {
    if (!moves[at(pin.part)]) continue;
    ties.push_back(
        {pin.part, -1, pin.strength, complex_point(pinned_point(pin, x)), complex_point(pin.position)});
  }
  for (const Joint& joint : springs_.joints) {
    ties.push_back({joint.first.part, joint.second.part, joint.strength,
                    complex_point(pinned_point(joint.first, x)),
                    complex_point(pinned_point(joint.second, x))});
  }
  return move_rigidly(fit_hinged_motions(returns, ties, newton_.size()), moves, limit, x);
}

/// Moves parts, one motion each, as far as they stay upright and no vertex goes further than `limit`; true if
/// that stopped it.
bool HoldMethod::move_rigidly(const std::vector<RigidMotion>& motions, const std::vector<char>& moves,
                              double limit, Points& x) {
  const auto is_moved = [&](int v) { return newton_.system().is_active(v) && moves[at(mesh_.part[at(v)])]; };
  double furthest = 0.0;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (!is_moved(v)) continue;
    const RigidMotion& motion = motions[at(mesh_.part[at(v)])];
    furthest = std::max(furthest, std::abs(motion.to - motion.from) +
                                      std::abs(motion.angle) * std::abs(complex_row(x, v) - motion.from));
  }
  if (furthest <= negligible * newton_.size()) return false;
  double share = furthest > limit ? limit / furthest : 1.0;
  for (int halvings = 0; halvings <= following_budget; ++halvings, share *= 0.5) {
    trial_ = x;
    for (int v = 0; v < mesh_.n_vertices; ++v) {
      if (!is_moved(v)) continue;
      const Complex p = motions[at(mesh_.part[at(v)])].at(complex_row(x, v), share);
      trial_.row(v) << p.real(), p.imag();
    }
    if (!newton_.keeps_upright(trial_)) continue;
    turn_factor(motions, moves, share);
    std::swap(x, trial_);
    return share < 1.0;
  }
  return false;
}

/// Parts that hang together share blocks of the factor, which is of no use when they turn by different
/// angles.
void HoldMethod::turn_factor(const std::vector<RigidMotion>& motions, const std::vector<char>& moves,
                             double share) {
  std::vector<Complex> turn(motions.size(), 1.0);
  for (std::size_t part = 0; part < motions.size(); ++part) {
    if (moves[part]) turn[part] = std::polar(1.0, share * motions[part].angle);
  }
  for (const Joint& joint : springs_.joints) {
    const Complex first = turn[at(joint.first.part)], second = turn[at(joint.second.part)];
    if (std::abs(first - second) > worth_a_factor) newton_.forget();
  }
  newton_.system().turn(turn);
}

}  // namespace planar
