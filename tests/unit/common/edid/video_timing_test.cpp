// SPDX-License-Identifier: Apache-2.0
// The expected values are those of `edid-decode --cvt`, `--dmt` and `--vic` (Debian's edid-decode).
#include "common/edid/video_timing.h"

#include <gtest/gtest.h>

#include "common/edid/timing_tables.h"

namespace cyclorama {
namespace {

TEST(VideoTiming, follows_the_formula_of_coordinated_timings) {
  EXPECT_EQ(coordinated_timing(1360, 768, 60.0, false),
            (VideoTiming{84750, {1360, 72, 136, 208, false}, {768, 3, 10, 17, true}}));
  EXPECT_EQ(coordinated_timing(1920, 1080, 75.0, false),
            (VideoTiming{220750, {1920, 136, 208, 344, false}, {1080, 3, 5, 42, true}}));
  EXPECT_EQ(coordinated_timing(1400, 1050, 60.0, false),
            (VideoTiming{121750, {1400, 88, 144, 232, false}, {1050, 3, 4, 32, true}}));
  EXPECT_EQ(coordinated_timing(2048, 1280, 60.0, true),
            (VideoTiming{174250, {2048, 48, 32, 80, true}, {1280, 3, 6, 28, false}}));
  EXPECT_EQ(coordinated_timing(1920, 1200, 60.0, true),
            (VideoTiming{154000, {1920, 48, 32, 80, true}, {1200, 3, 6, 26, false}}));
}

TEST(VideoTiming, finds_standard_timings_by_number_and_by_size) {
  EXPECT_EQ(dmt_timing(0x52), (VideoTiming{148500, {1920, 88, 44, 148, true}, {1080, 4, 5, 36, true}}));
  EXPECT_EQ(cta_timing(16), dmt_timing(0x52));
  EXPECT_EQ(dmt_timing(1920, 1080, 60), dmt_timing(0x52));
  EXPECT_EQ(dmt_timing(0x04), cta_timing(1));  // The border of the one is blanking of the other.
  EXPECT_EQ(dmt_timing(1920, 1080, 59), std::nullopt);
  for (const int unknown : {-1, 0, 8, 255}) EXPECT_EQ(cta_timing(unknown), std::nullopt);
  EXPECT_EQ(dmt_timing(0x0f), std::nullopt);  // Interlaced.
}

TEST(VideoTiming, has_only_possible_timings_in_its_tables) {
  int count = 0;
  for (int number = 0; number < 256; ++number) {
    for (const auto& timing : {dmt_timing(number), cta_timing(number)}) {
      if (!timing) continue;
      EXPECT_TRUE(timing->is_possible()) << number;
      EXPECT_LE(timing->refresh_hz(), 241.0) << number;
      ++count;
    }
  }
  EXPECT_EQ(count, 87 + 119);
  EXPECT_NEAR(cta_timing(5)->refresh_hz(), 60.0, 1e-9);  // Fields of 1080i.
}

TEST(VideoTiming, knows_which_timings_are_impossible) {
  VideoTiming timing = *dmt_timing(0x52);
  EXPECT_TRUE(timing.is_possible());
  timing.horizontal.sync = 0;
  EXPECT_FALSE(timing.is_possible());
  EXPECT_FALSE(VideoTiming{}.is_possible());
  timing = *dmt_timing(0x52);
  timing.vertical.back_porch = 65535;
  EXPECT_FALSE(timing.is_possible());
  timing = *dmt_timing(0x52);
  timing.clock_khz = 10;
  EXPECT_FALSE(timing.is_possible());
  EXPECT_FALSE(coordinated_timing(8, 1, 5000.0, false).is_possible());
}

}  // namespace
}  // namespace cyclorama
