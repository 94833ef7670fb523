// SPDX-License-Identifier: GPL-3.0-or-later
#include "posing/killing_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/checks.h"
#include "base/diameter.h"
#include "base/index.h"
#include "linear/least_squares.h"

namespace planar {

namespace {

constexpr double one_point = 1e-6;    // of the diameter: handles nearer to each other cannot say how to turn
constexpr int worth_a_thread = 1000;  // vertices

std::vector<int> reorder(const Mesh& mesh, std::vector<int> kept, SparseSolver& solver) {
  const std::vector<int> order = solver.fill_reducing_order(vertex_graph(mesh, kept));
  std::vector<int> result;
  result.reserve(kept.size());
  for (const int k : order) result.push_back(kept[at(k)]);
  return result;
}

}  // namespace

KillingSolver::System::System(const Mesh& mesh, std::vector<int> kept, Backend backend)
    : solver(SparseSolver::create(backend)),
      killing(mesh, reorder(mesh, std::move(kept), *solver)),
      unknown(killing.matrix().size),
      in_worker(mesh.n_vertices >= worth_a_thread) {
  solver->analyze(killing.matrix());
}

void KillingSolver::System::start(std::function<void()> factor) {
  if (in_worker) {
    worker.start(std::move(factor));
  } else {
    factor_later = std::move(factor);
  }
}

void KillingSolver::System::finish() {
  worker.finish();
  if (const auto factor = std::exchange(factor_later, nullptr)) factor();
}

KillingSolver::KillingSolver(Mesh mesh, Options options) : mesh_(std::move(mesh)), options_(options) {}

std::vector<Pin> KillingSolver::compile(const Handles& handles, const Eigen::VectorXd& weights,
                                        const std::vector<char>& patch) {
  std::vector<Pin> pins = make_pins(mesh_, handles, weights, patch);
  std::vector<int> used, inside;
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    if (mesh_.part[at(v)] >= 0) used.push_back(v);
    if (mesh_.interior[at(v)]) inside.push_back(v);
  }
  if (!all_ && !pins.empty()) all_.emplace(mesh_, std::move(used), options_.backend);
  const bool correct = options_.dirichlet && std::any_of(pins.begin(), pins.end(),
                                                         [this](const Pin& pin) { return is_smoothed(pin); });
  if (!inside_ && correct) inside_.emplace(mesh_, std::move(inside), options_.backend);
  return pins;
}

bool KillingSolver::is_smoothed(const Pin& pin) const {
  return !pin.patch &&
         std::any_of(pin.vertex.begin(), pin.vertex.begin() + static_cast<std::ptrdiff_t>(pin.n_corners),
                     [this](int v) { return mesh_.interior[at(v)] != 0; });
}

void KillingSolver::use(std::vector<Pin> pins) noexcept {
  wait();
  prepared_ = false;
  pins_ = std::move(pins);
}

void KillingSolver::wait() noexcept {
  if (all_) all_->worker.wait();
  if (inside_) inside_->worker.wait();
}

void KillingSolver::prepare(const Points& x, const Eigen::VectorXd& stiffness) {
  wait();
  prepared_ = false;
  x_ = x;
  stiffness_ = stiffness;
  fit_centres();
  any_bent_ = std::any_of(bent_.begin(), bent_.end(), [](char bent) { return bent != 0; });
  correct_ = options_.dirichlet && std::any_of(pins_.begin(), pins_.end(), [this](const Pin& pin) {
               return bent_[at(pin.part)] && is_smoothed(pin);
             });
  if (any_bent_) all_->start([this] { factor_all(); });
  if (correct_) inside_->start([this] { factor_inside(); });
  prepared_ = true;
}

void KillingSolver::fit_centres() {
  rigid_.assign(at(mesh_.n_parts), {Eigen::RowVector2d::Zero(), Eigen::RowVector2d::Zero(), 0.0, 0.0, 0.0});
  bent_.assign(at(mesh_.n_parts), 0);
  std::vector<double> spread(at(mesh_.n_parts));
  for (Pin& pin : pins_) {
    pin.position = pinned_point(pin, x_);
    RigidField& rigid = rigid_[at(pin.part)];
    rigid.centre += strength(pin) * pin.position;
    rigid.weight += strength(pin);
  }
  for (RigidField& rigid : rigid_) {
    if (rigid.weight != 0.0) rigid.centre /= rigid.weight;
  }
  for (const Pin& pin : pins_) {
    RigidField& rigid = rigid_[at(pin.part)];
    const Eigen::RowVector2d arm = pin.position - rigid.centre;
    spread[at(pin.part)] = std::max(spread[at(pin.part)], arm.norm());
    rigid.inertia += strength(pin) * arm.squaredNorm();
  }
  const double nearest = one_point * diameter(x_);
  for (std::size_t part = 0; part < bent_.size(); ++part) bent_[part] = spread[part] > nearest;
}

void KillingSolver::fit_rigid_fields(const Points& velocities) {
  for (RigidField& rigid : rigid_) {
    rigid.mean.setZero();
    rigid.rate = 0.0;
  }
  for (Pin& pin : pins_) {
    pin.velocity.setZero();
    for (const int row : pin.rows) pin.velocity += velocities.row(row) / static_cast<double>(pin.rows.size());
    rigid_[at(pin.part)].mean += strength(pin) * pin.velocity;
  }
  for (RigidField& rigid : rigid_) {
    if (rigid.weight != 0.0) rigid.mean /= rigid.weight;
  }
  for (const Pin& pin : pins_) {
    RigidField& rigid = rigid_[at(pin.part)];
    const Eigen::RowVector2d arm = pin.position - rigid.centre;
    const Eigen::RowVector2d velocity = pin.velocity - rigid.mean;
    rigid.rate += strength(pin) * (arm.x() * velocity.y() - arm.y() * velocity.x());
  }
  for (std::size_t part = 0; part < rigid_.size(); ++part) {
    rigid_[part].rate = bent_[part] ? rigid_[part].rate / rigid_[part].inertia : 0.0;
  }
  for (Pin& pin : pins_) pin.velocity -= rigid_[at(pin.part)].at(pin.position);
}

void KillingSolver::factor_all() {
  all_->killing.assemble(x_, stiffness_, bent_);
  for (const Pin& pin : pins_) {
    if (!bent_[at(pin.part)]) continue;
    for (std::size_t a = 0; a < pin.n_corners; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        all_->killing.add(pin.vertex[a], pin.vertex[b], strength(pin) * pin.weight[a] * pin.weight[b]);
      }
    }
  }
  all_->solver->factorize(all_->killing.matrix());
}

void KillingSolver::factor_inside() {
  inside_->killing.assemble(x_, stiffness_, bent_);
  inside_->solver->factorize(inside_->killing.matrix());
}

void KillingSolver::solve(const Points& velocities, Points& field) {
  prepared_ = false;  // should anything fail
  // K is zero on rigid fields, so [AKVF 7] is solved for what is left of the velocities after each part's
  // best rigid field. Rigid motions are exact this way, and parts that [AKVF 7] leaves undetermined have
  // nothing left.
  fit_rigid_fields(velocities);
  if (any_bent_) {
    all_->finish();
    if (options_.hard) {
      solve_hard();
    } else {
      solve_soft();
    }
  }
  if (correct_) {
    inside_->finish();
    correct_interior();
  }

  field.setZero(mesh_.n_vertices, 2);
  for (int v = 0; v < mesh_.n_vertices; ++v) {
    const int part = mesh_.part[at(v)];
    if (part < 0) continue;
    field.row(v) = rigid_[at(part)].at(x_.row(v));
    if (bent_[at(part)]) {
      const int slot = all_->killing.slot(v);
      field(v, 0) += all_->unknown[2 * slot];
      field(v, 1) += all_->unknown[2 * slot + 1];
    }
    if (correct_ && bent_[at(part)] && mesh_.interior[at(v)]) {
      const int slot = inside_->killing.slot(v);
      field(v, 0) += inside_->unknown[2 * slot];
      field(v, 1) += inside_->unknown[2 * slot + 1];
    }
  }
  if (!field.allFinite())
    throw SolveError("the field is not finite: the mesh or the velocities are too large or too distorted");
  prepared_ = true;
}

void KillingSolver::solve_soft() {
  Eigen::VectorXd& unknown = all_->unknown;
  unknown.setZero();
  for (const Pin& pin : pins_) {
    if (!bent_[at(pin.part)]) continue;
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      unknown.segment<2>(2 * all_->killing.slot(pin.vertex[c])) +=
          pin.strength * pin.weight[c] * pin.velocity.transpose();
    }
  }
  all_->solver->solve(unknown, unknown);
  for (Pin& pin : pins_) {
    if (!bent_[at(pin.part)]) continue;
    Eigen::RowVector2d reached = Eigen::RowVector2d::Zero();
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      reached += pin.weight[c] * unknown.segment<2>(2 * all_->killing.slot(pin.vertex[c])).transpose();
    }
    pin.force = pin.strength * (pin.velocity - reached);
  }
}

// U minimises E_K subject to C U = u. With A = K + CᵀC and Z = A⁻¹Cᵀ it is U = Z m, (C Z) m = u: A U + Cᵀμ =
// Cᵀu for some multipliers μ, hence U is in the span of Z. The same pattern as [AKVF 7], and exact. The pull
// of the handles is K U = Cᵀ(m - u). Of Z only C Z is kept: U = A⁻¹ Cᵀm costs one solve more.
void KillingSolver::solve_hard() {
  std::vector<Pin*> active;
  for (Pin& pin : pins_) {
    if (!bent_[at(pin.part)]) continue;
    active.push_back(&pin);
  }
  const auto n_constraints = static_cast<Eigen::Index>(2 * active.size());
  const auto pin_of = [&active](Eigen::Index k) -> Pin& { return *active[at(k / 2)]; };
  // Calls visit(row of A, weight) for the entries of a row of C.
  const auto for_entries = [&](Eigen::Index k, const auto& visit) {
    const Pin& pin = pin_of(k);
    for (std::size_t c = 0; c < pin.n_corners; ++c)
      visit(2 * all_->killing.slot(pin.vertex[c]) + k % 2, pin.weight[c]);
  };
  Eigen::VectorXd& unknown = all_->unknown;
  Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(n_constraints, n_constraints);
  Eigen::VectorXd wanted(n_constraints);
  for (Eigen::Index k = 0; k < n_constraints; ++k) {
    unknown.setZero();
    for_entries(k, [&](Eigen::Index row, double weight) { unknown[row] = weight; });
    all_->solver->solve(unknown, unknown);
    for (Eigen::Index i = 0; i < n_constraints; ++i) {
      for_entries(i, [&](Eigen::Index row, double weight) { schur(i, k) += weight * unknown[row]; });
    }
    wanted[k] = pin_of(k).velocity[k % 2];
  }
  // Dependent constraints (four handles in a triangle) make it singular; a rank-revealing factor meets them
  // by least squares.
  const Eigen::VectorXd multiplier = least_squares(schur, wanted, 1e-10);
  unknown.setZero();
  for (Eigen::Index k = 0; k < n_constraints; ++k) {
    for_entries(k, [&](Eigen::Index row, double weight) { unknown[row] += weight * multiplier[k]; });
    pin_of(k).force[k % 2] = multiplier[k] - wanted[k];
  }
  all_->solver->solve(unknown, unknown);
}

// [AKVF 8] with U = U° + d, d = 0 on the boundary: K_II d = -(K U°)_I, and by [AKVF 7] K U° is zero but at
// the handles. Where no handle lies inside, d = 0. Elsewhere this is also more accurate than moving the
// boundary's values to the right side.
void KillingSolver::correct_interior() {
  Eigen::VectorXd& unknown = inside_->unknown;
  unknown.setZero();
  for (const Pin& pin : pins_) {
    if (!bent_[at(pin.part)] || pin.patch) continue;
    for (std::size_t c = 0; c < pin.n_corners; ++c) {
      const int slot = inside_->killing.slot(pin.vertex[c]);
      if (slot >= 0) unknown.segment<2>(2 * slot) -= pin.weight[c] * pin.force.transpose();
    }
  }
  inside_->solver->solve(unknown, unknown);
}

}  // namespace planar
