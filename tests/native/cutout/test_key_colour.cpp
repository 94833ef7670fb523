// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "planar/cutout.h"
#include "support.h"

namespace planar::testing {
namespace {

constexpr int kSize = 40;

/// A red disc with a white hole in it, on white.
Colours picture() {
  Colours colours = Colours::Ones(kSize * kSize, 3);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double radius = std::hypot(x - 20, y - 15);
      if (radius < 12 && radius > 4) colours.row(y * kSize + x) << 1.0f, 0.1f, 0.0f;
    }
  }
  return colours;
}

TEST(KeyColour, FloodsFromTheBorder) {
  Colours colours = picture();
  colours(3, 0) = 0.92f;  // near enough to white
  const Keyed found = key_colour(colours, kSize, kSize);
  EXPECT_TRUE(found.keyed);
  EXPECT_TRUE(found.said.empty());
  EXPECT_EQ(found.colour, (std::array<float, 3>{1.0f, 1.0f, 1.0f}));
  EXPECT_EQ(found.alpha(0, 3), 0.0f);
  EXPECT_EQ(found.alpha(39, 39), 0.0f);
  EXPECT_EQ(found.alpha(15, 28), 1.0f);
  EXPECT_EQ(found.alpha(15, 20), 1.0f);  // the hole: no border reaches it
  colours(3, 0) = 0.9f;
  EXPECT_EQ(key_colour(colours, kSize, kSize).alpha(0, 3), 1.0f);
  EXPECT_EQ(key_colour(colours, kSize, kSize, 0.11).alpha(0, 3), 0.0f);
}

TEST(KeyColour, ArtMayTouchTheBorder) {
  Colours colours = picture();
  for (int y = 0; y < kSize; ++y) colours.row(y * kSize).setZero();
  const Keyed found = key_colour(colours, kSize, kSize);
  EXPECT_FALSE(found.keyed);  // a quarter of it
  EXPECT_NE(found.said.find("not plain"), std::string::npos) << found.said;
  EXPECT_TRUE((found.alpha.array() == 1.0f).all());
  for (int y = 20; y < kSize; ++y) colours.row(y * kSize).setOnes();
  EXPECT_TRUE(key_colour(colours, kSize, kSize).keyed);
}

TEST(KeyColour, NothingButBackground) {
  const Keyed found = key_colour(Colours::Constant(12, 3, 0.3f), 3, 4);
  EXPECT_FALSE(found.keyed);
  EXPECT_TRUE((found.alpha.array() == 1.0f).all());
  EXPECT_FALSE(found.said.empty());
  EXPECT_FALSE(key_colour(Colours::Ones(1, 3), 1, 1).keyed);
}

TEST(KeyColour, RefusesWhatIsNoImage) {
  EXPECT_REFUSAL(key_colour(Colours::Ones(5, 3), 2, 3), "colours has 5 rows, expected 6");
  EXPECT_REFUSAL(key_colour(Colours(0, 3), 0, 3), "an image of 3 x 0 pixels");
  Colours colours = Colours::Ones(6, 3);
  EXPECT_REFUSAL(key_colour(colours, 2, 3, -1.0), "tolerance");
  colours(4, 1) = std::nanf("");
  EXPECT_REFUSAL(key_colour(colours, 2, 3), "colours, row 4: not a finite number");
}

}  // namespace
}  // namespace planar::testing
