// SPDX-License-Identifier: GPL-3.0-or-later
#include "energy/rigid_motion.h"

namespace planar {

namespace {

std::complex<double> complex(const Eigen::RowVector2d& p) { return {p.x(), p.y()}; }

}  // namespace

Eigen::RowVector2d pinned_point(const Pin& pin, const Points& x) {
  Eigen::RowVector2d p = Eigen::RowVector2d::Zero();
  for (std::size_t c = 0; c < pin.n_corners; ++c) p += pin.weight[c] * x.row(pin.vertex[c]);
  return p;
}

std::vector<RigidMotion> fit_rigid_motions(const Mesh& mesh, const std::vector<Pin>& pins, const Points& x) {
  std::vector<RigidMotion> motions(static_cast<std::size_t>(mesh.n_parts));
  std::vector<std::complex<double>> turn(motions.size());
  for (const Pin& pin : pins) {
    RigidMotion& motion = motions[static_cast<std::size_t>(pin.part)];
    motion.weight += pin.strength;
    motion.centre += pin.strength * complex(pinned_point(pin, x));
    motion.target += pin.strength * complex(pin.position);
  }
  for (RigidMotion& motion : motions) {
    if (motion.weight == 0.0) continue;
    motion.centre /= motion.weight;
    motion.target /= motion.weight;
  }
  for (const Pin& pin : pins) {
    const auto part = static_cast<std::size_t>(pin.part);
    turn[part] += pin.strength * std::conj(complex(pinned_point(pin, x)) - motions[part].centre) *
                  (complex(pin.position) - motions[part].target);
  }
  for (std::size_t part = 0; part < motions.size(); ++part) motions[part].angle = std::arg(turn[part]);
  for (const Pin& pin : pins) {
    RigidMotion& motion = motions[static_cast<std::size_t>(pin.part)];
    const std::complex<double> p = complex(pinned_point(pin, x)), q = complex(pin.position);
    motion.before += pin.strength * std::norm(q - p);
    motion.after += pin.strength * std::norm(q - motion.at(p, 1.0));
  }
  return motions;
}

}  // namespace planar
