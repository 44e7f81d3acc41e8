// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/brightness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <climits>

namespace cyclorama::camera {
namespace {

TEST(BrightLevel, is_the_level_of_paper_rather_than_of_a_lamp) {
  GreyImage picture(640, 480, 40);
  for (int y = 0; y < 40; ++y) std::fill_n(picture.at(0, y), 40, std::uint8_t{255});  // 0.5 %
  EXPECT_EQ(bright_level(picture), 40);
  for (int y = 200; y < 400; ++y) std::fill_n(picture.at(200, y), 200, std::uint8_t{180});  // 13 %
  EXPECT_EQ(bright_level(picture), 180);
}

TEST(BrightLevel, is_defined_for_every_picture) {
  EXPECT_EQ(bright_level(GreyImage()), 0);
  EXPECT_EQ(bright_level(GreyImage(1, 1, 9)), 9);
  EXPECT_EQ(bright_level(GreyImage(33, 7, 0)), 0);
}

TEST(NextGain, reaches_the_target_band_in_every_scene_and_stays_there) {
  const GainRange range{16, 255, 3};
  // A camera whose picture is proportional to its gain and clips at 255.
  for (const double light : {0.3, 0.5, 1.0, 2.0, 6.0}) {
    for (long gain : {16L, 100L, 255L}) {
      const auto seen = [&] { return static_cast<int>(std::min(255.0, light * static_cast<double>(gain))); };
      for (int step = 0; step < 40; ++step) gain = next_gain(gain, seen(), range);
      const bool is_at_end = gain >= 253 || gain == 16;
      EXPECT_TRUE(is_at_end || (seen() >= 110 && seen() <= 235)) << light << ": " << seen() << " at " << gain;
      EXPECT_EQ(next_gain(gain, seen(), range), gain) << "it swings";
    }
  }
}

TEST(NextGain, stays_within_its_range_and_steps) {
  for (const GainRange& range : {GainRange{0, 1, 1}, GainRange{-10, 10, 4}, GainRange{5, 5, 1}, GainRange{9, 3, 1},
                                 GainRange{0, INT_MAX, 1}, GainRange{INT_MIN, INT_MAX, 0}}) {
    for (const long gain : {0L, -1000L, 7L, static_cast<long>(INT_MAX), LONG_MIN}) {
      for (const int level : {0, 150, 255}) {
        const long next = next_gain(gain, level, range);
        EXPECT_GE(next, range.min);
        EXPECT_LE(next, std::max(range.min, range.max));
        EXPECT_EQ((next - range.min) % std::max(range.step, 1L), 0);
      }
    }
  }
}

}  // namespace
}  // namespace cyclorama::camera
