// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "planar/distortion.h"
#include "planar/poser.h"
#include "support.h"

/// Drawn characters and poses published with other methods. They are not part of the project: the tests look
/// for them in the folder named by PLANAR_TEST_DATA at configure time.
namespace planar::testing {
namespace {

struct Pose {
  const char* character;
  std::size_t number;
};

std::string contents(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

Shape read_obj(const std::filesystem::path& path) {
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

class Character : public ::testing::TestWithParam<Pose> {};

TEST_P(Character, ReachesItsPoseWithoutFlips) {
  const std::filesystem::path folder = PLANAR_TEST_DATA;
  const std::string name = GetParam().character;
  if (!std::filesystem::exists(folder / (name + ".json"))) GTEST_SKIP() << "no " << name << " in " << folder;
  const Shape shape = read_obj(folder / (name + ".obj"));
  const std::vector<Points> poses = read_poses(folder / (name + ".json"));
  const Points& source = poses.at(2 * GetParam().number);
  std::vector<int> vertices;
  for (Eigen::Index i = 0; i < source.rows(); ++i) {
    Eigen::Index nearest;
    (shape.vertices.rowwise() - source.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
    vertices.push_back(static_cast<int>(nearest));
  }
  const Handles handles = at(shape, vertices);
  const Points start = handles.positions(shape.vertices);
  const Points targets = start + poses.at(2 * GetParam().number + 1) - source;
  const double diagonal = (shape.vertices.colwise().maxCoeff() - shape.vertices.colwise().minCoeff()).norm();

  Poser poser(shape.vertices, shape.triangles, {.method = PoserMethod::akvf});
  poser.set_handles(handles);
  for (int step = 1; step <= 40; ++step) {
    poser.move(start + (targets - start) * (step / 40.0));
    ASSERT_EQ(poser.report().flipped, 0) << step;
  }
  // Measured: at most 0.006 of the diagonal after the moves.
  EXPECT_LT(poser.report().furthest_handle, 0.01 * diagonal);
  poser.settle();
  EXPECT_TRUE(poser.report().converged) << poser.report().furthest_handle / diagonal;
  EXPECT_EQ(poser.report().flipped, 0);
  // The method forgets the rest shape, and is above the best known for it (2.14 and 2.20 at most).
  // Measured: 2.25 and 2.32 at most.
  const Distortion d = distortion(shape.vertices, poser.positions(), shape.triangles);
  EXPECT_LT(d.area, 2.35);
  EXPECT_LT(d.angle, 2.4);
}

INSTANTIATE_TEST_SUITE_P(Poses, Character,
                         ::testing::Values(Pose{"elephant", 0}, Pose{"giraffe", 0}, Pose{"giraffe", 1},
                                           Pose{"horse", 0}, Pose{"horse", 1}, Pose{"horse", 2},
                                           Pose{"horse", 3}, Pose{"horse", 4}, Pose{"racoon", 0},
                                           Pose{"racoon", 1}, Pose{"racoon", 2}, Pose{"racoon", 3}),
                         [](const auto& kind) {
                           return kind.param.character + std::to_string(kind.param.number);
                         });

}  // namespace
}  // namespace planar::testing
