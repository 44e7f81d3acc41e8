// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/pacing_meter.h"

#include <gtest/gtest.h>

namespace cyclorama::output {
namespace {

using Light = HeadShown::Light;

constexpr double kHz = 100.0;  // 10 ms.

class PacingMeterTest : public ::testing::Test {
 protected:
  std::optional<PictureStep> shown(double at_ms, Light light = Light::kNew) {
    const auto at = std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>(at_ms));
    return meter_.take({light, TimePoint(at), kHz});
  }
  PacingMeter meter_;
};

TEST_F(PacingMeterTest, measures_the_time_between_pictures) {
  EXPECT_FALSE(shown(100.0));
  for (int n = 1; n < 5; ++n) {
    const auto step = shown(100.0 + 10.0 * n);
    ASSERT_TRUE(step);
    EXPECT_NEAR(to_milliseconds(step->interval), 10.0, 1e-5);
    EXPECT_EQ(step->missed, 0U);
    EXPECT_FALSE(step->is_late);
  }
}

TEST_F(PacingMeterTest, distinguishes_late_from_missed_refreshes) {
  shown(0.0);
  EXPECT_FALSE(shown(12.4)->is_late);
  const auto late = shown(12.4 + 12.6);
  EXPECT_TRUE(late->is_late);
  EXPECT_EQ(late->missed, 0U);
  const auto missed = shown(25.0 + 15.1);
  EXPECT_FALSE(missed->is_late);
  EXPECT_EQ(missed->missed, 1U);
  EXPECT_EQ(shown(40.1 + 1000.0)->missed, 99U);
}

TEST_F(PacingMeterTest, is_not_measured_without_new_pictures_or_on_dark_heads) {
  for (const Light pause : {Light::kSame, Light::kDark}) {
    shown(0.0);
    EXPECT_TRUE(shown(10.0));
    EXPECT_FALSE(shown(20.0, pause));
    EXPECT_FALSE(shown(5000.0));
    EXPECT_TRUE(shown(5010.0));
    shown(5020.0, pause);
  }
}

TEST_F(PacingMeterTest, does_not_go_backwards) {
  shown(100.0);
  EXPECT_FALSE(shown(100.0));
  EXPECT_FALSE(shown(50.0));  // A time from another card's clock.
  EXPECT_TRUE(shown(60.0));
}

}  // namespace
}  // namespace cyclorama::output
