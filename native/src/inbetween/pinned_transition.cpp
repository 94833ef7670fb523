// SPDX-License-Identifier: GPL-3.0-or-later
#include "inbetween/pinned_transition.h"

#include <algorithm>
#include <map>
#include <string>

#include "base/checks.h"
#include "base/index.h"
#include "mesh/pin.h"

namespace planar {

namespace {

/// μ. Three pins between twelve published poses that were up to 0.23 of the diagonal off end within
/// 1.3e-7 of it, at the 1000 of posing within 1.3e-4, in as many steps.
constexpr double pin_strength = 1e6;

std::vector<PinRows> pins_of(const InbetweenOptions& options) {
  const Eigen::Index n_handles = options.pins.size();
  const Eigen::VectorXi& groups = options.pin_groups;
  std::vector<PinRows> pins;
  if (groups.size() == 0) {
    for (int row = 0; row < static_cast<int>(n_handles); ++row) pins.push_back({row});
    return pins;
  }
  require_rows("pin_groups", groups.size(), n_handles, "handle");
  std::map<int, PinRows> by_label;
  for (int row = 0; row < static_cast<int>(n_handles); ++row) by_label[groups[row]].push_back(row);
  for (auto& [label, rows] : by_label) pins.push_back(std::move(rows));
  return pins;
}

/// A flag a pin of those that are held, for each transition.
std::vector<std::vector<char>> held_pins(const InbetweenOptions& options, const std::vector<PinRows>& pins,
                                         std::size_t n_transitions) {
  if (options.pinned.size() == 0) return {n_transitions, std::vector<char>(pins.size(), 1)};
  const auto& pinned = options.pinned;
  require_rows("pinned", pinned.rows(), static_cast<Eigen::Index>(n_transitions), "pair of keys");
  if (pinned.cols() != options.pins.size()) {
    throw std::invalid_argument("pinned has " + std::to_string(pinned.cols()) + " columns, expected " +
                                std::to_string(options.pins.size()) + " (one per handle of pins)");
  }
  std::vector<std::vector<char>> held(n_transitions);
  for (std::size_t k = 0; k < n_transitions; ++k) {
    for (const PinRows& rows : pins) {
      const auto is_held = [&](int row) { return pinned(static_cast<Eigen::Index>(k), row); };
      const bool first = is_held(rows[0]);
      if (!std::all_of(rows.begin(), rows.end(), [&](int row) { return is_held(row) == first; })) {
        throw std::invalid_argument(row_of("pinned", static_cast<Eigen::Index>(k)) +
                                    "handles of one group must be held together or not at all");
      }
      held[k].push_back(first);
    }
  }
  return held;
}

/// The mean turn of the edges at each pin.
Eigen::VectorXd turns_at(const EdgeGraph& graph, const FramePins& pins, const Eigen::VectorXd& edge_turns) {
  std::vector<double> sum(graph.vertex_count()), count(graph.vertex_count());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    for (const int v : graph.edges[i]) {
      sum[at(v)] += edge_turns[static_cast<Eigen::Index>(i)];
      count[at(v)] += 1.0;
    }
  }
  Eigen::VectorXd turns(static_cast<Eigen::Index>(pins.pins.size()));
  for (std::size_t p = 0; p < pins.pins.size(); ++p) {
    double total = 0.0, edges = 0.0;
    for (const int row : pins.pins[p]) {
      for (int corner = 0; corner < 3; ++corner) {
        if (pins.handles.weights(row, corner) == 0.0) continue;
        total += sum[at(pins.handles.vertices(row, corner))];
        edges += count[at(pins.handles.vertices(row, corner))];
      }
    }
    turns[static_cast<Eigen::Index>(p)] = edges > 0.0 ? total / edges : 0.0;
  }
  return turns;
}

}  // namespace

FramePins::FramePins(const EdgeGraph& graph, const std::vector<Points>& keys, const InbetweenOptions& options)
    : handles(options.pins), pins(pins_of(options)), held(held_pins(options, pins, keys.size() - 1)) {
  if (graph.triangles.rows() == 0) {
    throw std::invalid_argument("pins: edges without faces have none; give triangles");
  }
  const Mesh mesh(graph.n_vertices, graph.triangles);
  make_pins(mesh, handles, Eigen::VectorXd::Ones(handles.size()), {});  // for its checks
  part = parts_of(handles, graph.part);
  std::vector<char> has_pins(at(graph.n_parts));
  for (const int p : part) {
    if (p >= 0) has_pins[at(p)] = 1;
  }
  std::vector<Eigen::Index> rows;
  for (Eigen::Index t = 0; t < graph.triangles.rows(); ++t) {
    if (has_pins[at(graph.part[at(graph.triangles(t, 0))])]) rows.push_back(t);
  }
  triangles = graph.triangles(rows, Eigen::all);
}

PinnedTransition::PinnedTransition(const EdgeGraph& graph, const FramePins& pins, std::size_t k,
                                   const Points& from, const Points& to, const Edges& joints,
                                   const Eigen::VectorXd& edge_turns)
    : graph_(graph),
      held_(pins.held[k]),
      ways_(pins.handles.positions(from), pins.handles.positions(to), pins.pins,
            turns_at(graph, pins, edge_turns)),
      joints_(joints) {
  const auto part_of = [&](Eigen::Index joint, int side) { return at(graph.part[at(joints_(joint, side))]); };
  std::vector<Edges::Index> carrying(at(graph.n_parts), -1);  // joint of each part
  for (Eigen::Index j = 0; j < joints_.rows(); ++j) carrying[part_of(j, 1)] = j;
  std::vector<std::size_t> depth(carrying.size());
  for (std::size_t part = 0; part < depth.size(); ++part) {
    for (std::size_t p = part; carrying[p] != -1; p = part_of(carrying[p], 0)) ++depth[part];
  }
  std::vector<char> has_pins(depth.size());
  for (std::size_t p = 0; p < pins.pins.size(); ++p) {
    if (!held_[p]) continue;
    for (const int row : pins.pins[p]) {
      const int part = pins.part[at(row)];
      if (part < 0) continue;
      has_pins[at(part)] = 1;
      layers_.resize(std::max(layers_.size(), depth[at(part)] + 1));
      layers_[depth[at(part)]].rows.push_back(row);
    }
  }
  if (layers_.empty()) return;
  layers_.resize(*std::max_element(depth.begin(), depth.end()) + 1);
  for (std::size_t part = 0; part < depth.size(); ++part) {
    if (carrying[part] == -1) continue;
    Layer& layer = layers_[depth[part]];
    layer.joints.push_back(carrying[part]);
    if (has_pins[part]) layer.joint_vertex.push_back(joints_(carrying[part], 1));
  }
  for (Layer& layer : layers_) {
    const Eigen::VectorXi vertex = Eigen::Map<const Eigen::VectorXi>(
        layer.joint_vertex.data(), static_cast<Eigen::Index>(layer.joint_vertex.size()));
    const Handles held_joints = Handles::at_vertices(vertex, graph.n_vertices);
    const auto n_pins = static_cast<Eigen::Index>(layer.rows.size()), n = n_pins + vertex.size();
    HandleSet& set = layer.handles;
    set.handles.vertices.resize(n, 3);
    set.handles.weights.resize(n, 3);
    set.handles.vertices << pins.handles.vertices(layer.rows, Eigen::all), held_joints.vertices;
    set.handles.weights << pins.handles.weights(layer.rows, Eigen::all), held_joints.weights;
    set.strength.setConstant(n, pin_strength);
    set.patch.assign(at(n), 0);
  }
}

void PinnedTransition::join(PinnedTransition& before, PinnedTransition& after, KeyGaps gaps) {
  std::vector<char> both = before.held_;
  for (std::size_t p = 0; p < both.size(); ++p) both[p] = both[p] && after.held_[p];
  PinWays::join(before.ways_, after.ways_, both, gaps);
}

/// Moves the parts of a layer as much as where they hang was moved.
void PinnedTransition::carry_along(const Layer& layer, const Points& frame, Points& x) const {
  std::vector<Eigen::RowVector2d> way(at(graph_.n_parts), Eigen::RowVector2d::Zero());
  for (const Eigen::Index j : layer.joints) {
    const int carrier = joints_(j, 0);
    way[at(graph_.part[at(joints_(j, 1))])] = x.row(carrier) - frame.row(carrier);
  }
  for (int v = 0; v < graph_.n_vertices; ++v) {
    if (graph_.part[at(v)] >= 0) x.row(v) += way[at(graph_.part[at(v)])];
  }
}

Points PinnedTransition::held(const Points& frame, const Points& places, PinHolder& holder) const {
  Points x = frame;
  if (layers_.empty()) return x;
  holder.begin(frame);
  for (const Layer& layer : layers_) {
    if (!layer.joints.empty()) carry_along(layer, frame, x);
    if (layer.rows.empty()) continue;
    Points targets(layer.handles.handles.size(), 2);
    targets << places(layer.rows, Eigen::all), x(layer.joint_vertex, Eigen::all);
    holder.hold(layer.handles, targets, x);
  }
  return x;
}

}  // namespace planar
