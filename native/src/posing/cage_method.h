// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "cage/cage.h"
#include "mesh/orientation.h"
#include "mesh/pin.h"
#include "posing/dense_polish.h"
#include "posing/hold_method.h"
#include "posing/posing_method.h"

namespace planar {

/// Another method on a cage round the mesh: the handles are those of the mesh, which is carried along by its
/// vertices' places in the cage, and so are joints. The cage is refined near handles and joints.
///
/// The positions that it starts from are the cage's nearest ones and what these leave. Of that, turned with
/// the triangles of the cage, the mesh keeps a share with each move. Parts that the method does not move stay
/// as they are.
///
/// Where the other method is HoldMethod and the mesh has no more than most_polished vertices, the cage stands
/// in for it only while it moves. It begins at its own minimum for handles that pull at it as they do at the
/// mesh, so that nothing is seen of a change from one to the other, and what the mesh has beside that is let
/// go of as it moves on; once it has settled, refine() and settle() take the mesh to its own minimum.
class CageMethod final : public PosingMethod {
 public:
  /// What to solve on the cage with: its rest, triangles, orientation (to outlive the method) and stiffness.
  using Make = std::function<std::unique_ptr<PosingMethod>(const Points&, const Triangles&,
                                                           const Orientation&, const Eigen::VectorXd&)>;

  /// Vertices of a mesh that is solved itself in the end. Of 100k a few steps take a second,
  /// and the factor 300 MB.
  static constexpr Eigen::Index most_polished = 150'000;

  /// \param rest n×2
  /// \param centre what the positions given to the functions below are relative to
  /// \param orientation of the dense mesh, to outlive the object
  /// \param stiffness m factors, or empty
  /// \param kept of what the fit leaves, by a move or refine(); unless 1, settle() keeps nothing
  CageMethod(Coarse coarse, const Points& rest, const Eigen::RowVector2d& centre,
             const Orientation& orientation, const Eigen::VectorXd& stiffness, double kept, Make make);

  void set_handles(const HandleSet& handles) override { set(handles, joints_, false); }
  void set_joints(const JointSet& joints) override { set(handles_, joints, true); }
  void move(const Points& targets, Points& x, Report& report) override;
  void refine(const Points& targets, Points& x, Report& report) override;
  void settle(const Points& targets, Points& x, Report& report) override;
  void reset() noexcept override;
  bool counts_flipped() const override { return true; }

 private:
  using Action = void (PosingMethod::*)(const Points& targets, Points& x, Report& report);
  using Polish = void (DensePolish::*)(const Points& targets, const std::function<bool(double)>& progress,
                                       Points& x, Report& report);

  /// A cage and what is made for it.
  struct Solved {
    Cage cage;
    Mesh mesh;
    Orientation orientation;
    Suspects suspects;
    CageFit fit;
    Eigen::VectorXd stiffness;  ///< of its triangles, or empty
    std::unique_ptr<PosingMethod> method;
    HoldMethod* hold;                  ///< the method, where it is that and the mesh is polished
    std::optional<CageSample> sample;  ///< for that
    std::vector<int> near;             ///< dense vertices where it is refined, ascending

    Solved(Cage cage, const CageMethod& owner, std::vector<int> near);
  };

  void set(const HandleSet& handles, const JointSet& joints, bool new_joints);
  void require_points(const Handles& handles, const char* name) const;
  void act(Action action, int rounds, double kept, const Points& targets, Points& x, Report& report);
  void polish(Polish action, const Points& targets, Points& x, Report& report);
  bool is_as_left(const Points& x) const;
  void take(const Points& x);
  void take_beside(Remainder beside);
  bool balance(const Points& x);
  std::vector<double> nearness() const;
  std::vector<double> left_after(double kept) const;
  Remainder::Turns turns_at(const Points& x, const std::vector<double>& left) const;
  Points offsets(const std::vector<double>& left) const;
  void carry(const std::vector<char>& parts, Points& x) const;

  Coarse coarse_;
  Points rest_;
  Eigen::RowVector2d centre_;
  const Orientation& orientation_;
  Eigen::VectorXd stiffness_;
  double size_;
  double kept_;
  Make make_;
  std::unique_ptr<Solved> on_;  ///< none before there are handles

  Points x_;                   ///< of the cage
  bool unseen_ = true;         ///< the mesh's positions come from elsewhere
  std::vector<int> repaired_;  ///< dense vertices that were not left where the cage has them
  Points repaired_places_;
  Remainder beside_;          ///< what the fit left of them
  Points balanced_{0, 2};     ///< where the cage was at its own minimum beside them; or none
  std::vector<double> left_;  ///< how much of what was left then there still is, by part

  std::unique_ptr<DensePolish> polish_;  ///< once it is needed
  bool coarse_settled_ = false;          ///< what is to come is for the mesh itself

  HandleSet handles_;
  JointSet joints_;
  Handles cage_handles_;
  std::vector<char> stays_;   ///< n: vertices of parts without handles
  std::vector<char> pinned_;  ///< n: these, and vertices of handles
  std::vector<char> held_;    ///< by part of the cage: it, or what hangs together with it, has handles
};

}  // namespace planar
