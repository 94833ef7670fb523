// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "planar/akvf.h"

TEST(KillingField, RefusesAnEmptyMesh) {
  EXPECT_THROW(planar::killing_field({}, {}, {}, {}), std::invalid_argument);
}
