// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/capture_time.h"

#include <gtest/gtest.h>

namespace cyclorama::camera {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

const TimePoint kNow(std::chrono::seconds(1000));
const Duration kExposure = milliseconds(5);

TEST(CaptureTime, uses_a_stamp_at_the_start_of_exposure_unchanged) {
  EXPECT_EQ(capture_time({true, true, kNow - milliseconds(30)}, kExposure, kNow), kNow - milliseconds(30));
}

TEST(CaptureTime, subtracts_the_exposure_from_a_stamp_at_its_end) {
  EXPECT_EQ(capture_time({true, false, kNow - milliseconds(30)}, kExposure, kNow), kNow - milliseconds(35));
  EXPECT_EQ(capture_time({true, false, kNow}, Duration::zero(), kNow), kNow);
}

TEST(CaptureTime, ignores_a_stamp_of_another_clock) {
  for (const TimePoint at : {TimePoint{}, kNow + nanoseconds(1), kNow + hours(9), kNow - kMaxStampAge - nanoseconds(1),
                             TimePoint::min(), TimePoint::max()}) {
    EXPECT_EQ(capture_time({true, true, at}, kExposure, kNow), kNow);
    EXPECT_EQ(capture_time({true, false, at}, kExposure, kNow), kNow);
  }
  EXPECT_EQ(capture_time({false, true, kNow - milliseconds(30)}, kExposure, kNow), kNow);
}

TEST(CaptureTime, is_bounded_for_any_exposure) {
  for (const Duration exposure : {Duration::min(), Duration::max()}) {
    const TimePoint at = capture_time({true, false, kNow - milliseconds(30)}, exposure, kNow);
    EXPECT_LE(at, kNow);
    EXPECT_GE(at, kNow - kMaxStampAge - std::chrono::seconds(1));
  }
}

}  // namespace
}  // namespace cyclorama::camera
