// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/stepped_range.h"

#include <gtest/gtest.h>

namespace cyclorama::camera {
namespace {

TEST(SteppedRange, gives_the_nearest_step_and_never_one_beyond_the_range) {
  EXPECT_EQ(nearest_step(16, 4096, 8, 643), 640);
  EXPECT_EQ(nearest_step(16, 4096, 8, 645), 648);
  EXPECT_EQ(nearest_step(3, 2047, 1, 50), 50);
  EXPECT_EQ(nearest_step(1, 5000, 312, 620), 625);
  EXPECT_EQ(nearest_step(0, 10, 4, 10), 8);
  EXPECT_EQ(nearest_step(0, 10, 4, 1000), 8);
  EXPECT_EQ(nearest_step(5, 10, 4, -7), 5);
}

TEST(SteppedRange, survives_ranges_that_make_no_sense) {
  EXPECT_EQ(nearest_step(5, 10, 0, 7), 7);
  EXPECT_EQ(nearest_step(5, 3, 2, 7), 5);
  EXPECT_EQ(nearest_step(5, 5, -1, 9), 5);
}

}  // namespace
}  // namespace cyclorama::camera
