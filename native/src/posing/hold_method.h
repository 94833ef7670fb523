// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "energy/hinged_fit.h"
#include "energy/newton.h"
#include "energy/rigid_fit.h"
#include "mesh/mesh.h"
#include "mesh/pin.h"
#include "parallel/worker.h"
#include "posing/hold_springs.h"
#include "posing/posing_method.h"

namespace planar {

/// PoserMethod::hold: descends the rest energy and the pins' springs, see planar/poser.h.
class HoldMethod final : public PosingMethod {
 public:
  /// \param orientation of the rest, to outlive the object
  /// \param stiffness m factors, or empty
  HoldMethod(const Points& rest, const Triangles& triangles, const Orientation& orientation,
             const Eigen::VectorXd& stiffness);

  /// For triangles that do not fit together at rest, each where rest_of says. Parts without handles are not
  /// left out then, but relax.
  ///
  /// \param size of the shape: lengths are small or large beside it
  HoldMethod(Mesh mesh, const RestOf& rest_of, const Orientation& orientation, double size);

  using LineSpring = HoldSprings::LineSpring;
  /// Beside the handles; to be called after set_handles(), which removes them.
  void set_lines(std::vector<LineSpring> lines);

  /// Another rest shape, with the same triangles and without stiffness, of which x is a rigid motion part by
  /// part at the next call. The orientation is to be its by now.
  void set_rest(const Points& rest);

  /// As reset(), but the positions come from a descent: parts do not begin anew from the rest, whatever lies
  /// the other way round there.
  void go_on() noexcept;

  /// Whether a part goes round one of its inner vertices more often than at rest.
  bool is_knotted(const Points& x) const;

  /// A few of the steps of settle(), with refine()'s limit on motion.
  void advance(const Points& targets, Points& x, Report& report);

  /// settle() in so many steps at most, before each of which the caller is told; what he throws ends it.
  void settle_within(int steps, const std::function<void()>& before_step, const Points& targets, Points& x,
                     Report& report);

  void set_handles(const HandleSet& handles) override;
  /// \pre made with a rest shape
  void set_joints(const JointSet& joints) override;
  void move(const Points& targets, Points& x, Report& report) override;
  void refine(const Points& targets, Points& x, Report& report) override;
  void settle(const Points& targets, Points& x, Report& report) override;
  void reset() noexcept override;

 private:
  using Joint = HoldSprings::Joint;

  Newton::Budget two_steps(double limit) const;
  /// \param ends no further call will go on from there
  void descend(const Points& targets, const Newton::Budget& budget, bool ends, Points& x, Report& report);
  void descend_from(const Newton::Budget& budget, Points& x, Report& report);
  bool follow_rigidly(double limit, Points& x);
  bool turn_on_joints(double limit, Points& x);
  bool move_rigidly(const std::vector<RigidMotion>& motions, const std::vector<char>& moves, double limit,
                    Points& x);
  void turn_factor(const std::vector<RigidMotion>& motions, const std::vector<char>& moves, double share);
  std::vector<char> knotted(const Points& x) const;
  std::vector<char> tangled(const Points& x) const;
  std::vector<PointPair> ways_from(const Points& x) const;
  void set_active();
  void set_reference(const Points& x);
  bool begin_from_rest(const std::vector<char>& parts, Points& x);

  Mesh mesh_;
  const Orientation& orientation_;
  Points rest_;                       ///< n×2, or 0×2 where triangles do not fit together
  Eigen::VectorXi windings_at_rest_;  ///< n
  bool free_ = false;                 ///< parts without handles relax
  std::vector<Joint> joints_;
  std::vector<int> group_;  ///< of each part: those that joints connect are one
  HoldSprings springs_;
  Newton newton_;
  Points origin_;  ///< positions at the first call with these handles and joints; or 0×2
  Points start_, trial_;
  Points ahead_;                 ///< where the next factor is made
  bool unseen_ = false;          ///< x comes from elsewhere: it may be knotted
  bool may_be_tangled_ = false;  ///< as it was turned over in part, and has not been seen to come right since
  Worker worker_;                ///< last, so that its thread ends before what it uses
};

}  // namespace planar
