// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planar/types.h"

/// Reads drawn characters and their poses: the project's own, which examples/draw_characters.py writes, and
/// ones published with other methods, which are not part of the project.
namespace planar::characters {

std::pair<Points, Triangles> read_obj(const std::filesystem::path& path);

/// Handles, which are vertices, where they are at rest, and where they go.
struct Pose {
  std::vector<int> handles;
  Points start, targets;
};

struct Character {
  Points vertices;
  Triangles triangles;
  std::vector<Pose> poses;

  double diagonal() const { return (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).norm(); }
};

/// Nothing if the folder does not have it.
std::optional<Character> read(const std::filesystem::path& folder, const std::string& name);

}  // namespace planar::characters
