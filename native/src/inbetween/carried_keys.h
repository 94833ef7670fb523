// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "cage/cage.h"
#include "inbetween/part_placer.h"
#include "inbetween/pinned_transition.h"
#include "mesh/edge_graph.h"
#include "mesh/orientation.h"
#include "planar/inbetween.h"

namespace planar {

/// The keys of a dense mesh as those of a cage, and the frames between them carried back. What a cage cannot
/// have of a key is turned with it, blended from key to key; triangles that this turns over although they lie
/// the same way round in both keys are put right.
class CarriedKeys {
 public:
  /// None for what is solved as it is, see coarse_for_cage(); else the graph is taken. The cage is refined
  /// near pins that are single points. \param keys to outlive the object \param pins of the dense mesh, or
  /// null
  static std::unique_ptr<CarriedKeys> of(const std::vector<Points>& keys, EdgeGraph& graph,
                                         const InbetweenOptions& options, const FramePins* pins);

  CarriedKeys(const std::vector<Points>& keys, EdgeGraph graph, const InbetweenOptions& options,
              const Points& reference, Coarse coarse);

  /// c×2 each.
  const std::vector<Points>& keys() const { return cage_keys_; }
  const Triangles& triangles() const { return cage_.triangles; }

  /// The options with rest shape and turns for the cage, without anchors and joints.
  InbetweenOptions options(const InbetweenOptions& dense) const;
  /// What holds the parts of the cage, from anchors and joints of the dense mesh, checked.
  Ties ties(const Eigen::VectorXi& anchor, const Edges& joints) const;
  /// Pins and joints of the dense mesh, checked, as those of the cage that have the dense ones where they
  /// should be. To be called once; this must outlive them.
  void carry(FramePins& pins);
  /// The numbers that parts of the cage have in the dense mesh, ascending.
  std::vector<int> parts(const std::vector<int>& of_cage) const;
  /// Parts and vertices of the dense mesh: what anchors, joints and turns are checked against.
  const EdgeGraph& graph() const { return graph_; }

  /// The frame (n×2) of a frame x (c×2) between keys k and k+1, at a share u of the way.
  Points carried(const Points& x, std::size_t k, double u) const;

 private:
  /// Where dense vertices are on a frame x between keys k and k+1, at u.
  class Spots {
   public:
    Spots(const CarriedKeys& of, const Points& x, std::size_t k, double u);
    Eigen::RowVector2d of(int vertex) const;
    /// Without anything that a cage cannot have.
    bool are_the_cages() const { return turned_before_.empty() && turned_after_.empty(); }

   private:
    const CarriedKeys& of_;
    const Points& x_;
    double share_;
    const Remainder &before_, &after_;
    Remainder::Turns turned_before_, turned_after_;
  };

  const std::vector<Points>& dense_keys_;
  Points reference_;  ///< n×2: what places in the cage refer to
  EdgeGraph graph_;
  Cage cage_;
  Mesh mesh_;
  Suspects suspects_;
  std::vector<int> dense_part_;  ///< of each part of the cage
  Eigen::MatrixXi turns_;        ///< (K-1)×parts of the dense mesh
  std::vector<Points> cage_keys_;
  std::vector<Remainder> beside_;
  std::vector<char> pinned_;  ///< n flags: of handles of pins
  std::vector<Orientation>
      upright_;  ///< of key k, but for triangles that lie the other way round in the next
};

}  // namespace planar
