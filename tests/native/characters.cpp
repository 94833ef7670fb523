// SPDX-License-Identifier: GPL-3.0-or-later
#include "characters.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace planar::characters {

namespace {

std::string contents(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The point lists under the keys "src" and "dst", in the order of the file: those of pose 0, of pose 1, ...
std::vector<Points> read_poses(const std::filesystem::path& path) {
  const std::string text = contents(path);
  std::vector<Points> result;
  std::size_t here = 0;
  const auto next_key = [&text](std::size_t from) {
    return std::min(text.find("\"src\"", from), text.find("\"dst\"", from));
  };
  while ((here = next_key(here)) != std::string::npos) {
    here = text.find('[', here);
    const std::size_t end = std::min(text.find('"', here), text.size());
    std::vector<double> values;
    for (; here < end; ++here) {
      if (std::string("-0123456789").find(text[here]) == std::string::npos) continue;
      char* after = nullptr;
      values.push_back(std::strtod(&text[here], &after));
      here = static_cast<std::size_t>(after - text.data());
    }
    result.emplace_back(Eigen::Map<Points>(values.data(), static_cast<Eigen::Index>(values.size() / 2), 2));
  }
  return result;
}

/// The vertex next to each point.
std::vector<int> nearest_vertices(const Points& vertices, const Points& points) {
  std::vector<int> result;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    Eigen::Index nearest = 0;
    (vertices.rowwise() - points.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
    result.push_back(static_cast<int>(nearest));
  }
  return result;
}

}  // namespace

std::pair<Points, Triangles> read_obj(const std::filesystem::path& path) {
  std::vector<double> x;
  std::vector<int> corners;
  std::istringstream lines(contents(path));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, word;
    words >> kind;
    for (int i = 0; i < (kind == "v" ? 2 : 3) && (kind == "v" || kind == "f"); ++i) {
      words >> word;
      if (kind == "v") x.push_back(std::stod(word));
      if (kind == "f") corners.push_back(std::stoi(word) - 1);
    }
  }
  return {Eigen::Map<Points>(x.data(), static_cast<Eigen::Index>(x.size() / 2), 2),
          Eigen::Map<Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3)};
}

std::optional<Character> read(const std::filesystem::path& folder, const std::string& name) {
  if (!std::filesystem::exists(folder / (name + ".json"))) return {};
  auto [vertices, triangles] = read_obj(folder / (name + ".obj"));
  const std::vector<Points> points = read_poses(folder / (name + ".json"));
  std::vector<Pose> poses;
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    Pose pose{nearest_vertices(vertices, points[i]), {}, {}};
    pose.start = vertices(pose.handles, Eigen::all);
    pose.targets = pose.start + points[i + 1] - points[i];
    poses.push_back(std::move(pose));
  }
  return Character{std::move(vertices), std::move(triangles), std::move(poses)};
}

}  // namespace planar::characters
