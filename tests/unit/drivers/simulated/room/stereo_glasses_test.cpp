// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/room/stereo_glasses.h"

#include <gtest/gtest.h>

namespace cyclorama::simulated {
namespace {

TEST(StereoGlasses, pass_each_eyes_part_over_the_whole_field) {
  RgbImage head(6, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 6; ++x) head.at(x, y)[0] = static_cast<std::uint8_t>(10 * y + x);
  }
  const auto red = [&](StereoPacking packing, Eye eye, int x, int y) {
    return int{seen_through_glasses(head, packing, eye).at(x, y)[0]};
  };
  EXPECT_EQ(red(StereoPacking::kSideBySide, Eye::kLeft, 0, 3), 30);
  EXPECT_EQ(red(StereoPacking::kSideBySide, Eye::kLeft, 1, 3), 30);
  EXPECT_EQ(red(StereoPacking::kSideBySide, Eye::kLeft, 5, 3), 32);
  EXPECT_EQ(red(StereoPacking::kSideBySide, Eye::kRight, 0, 3), 33);
  EXPECT_EQ(red(StereoPacking::kSideBySide, Eye::kRight, 5, 3), 35);
  EXPECT_EQ(red(StereoPacking::kTopBottom, Eye::kLeft, 5, 0), 5);
  EXPECT_EQ(red(StereoPacking::kTopBottom, Eye::kLeft, 5, 3), 15);
  EXPECT_EQ(red(StereoPacking::kTopBottom, Eye::kRight, 5, 1), 25);
  EXPECT_EQ(red(StereoPacking::kTopBottom, Eye::kRight, 5, 3), 35);
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    EXPECT_EQ(seen_through_glasses(head, StereoPacking::kFrameSequential, eye), head);
    EXPECT_TRUE(seen_through_glasses({}, StereoPacking::kSideBySide, eye).empty()) << "a projector that is off";
  }
}

}  // namespace
}  // namespace cyclorama::simulated
