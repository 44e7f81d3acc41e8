// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/capture.h"

#include <gtest/gtest.h>

#include "tests/doubles/scripted_camera.h"

namespace cyclorama::tracker {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::shared_ptr<const camera::CameraFrame> frame(std::uint64_t sequence) {
  auto made = std::make_shared<camera::CameraFrame>();
  made->pixels = GreyImage(2, 2);
  made->sequence = sequence;
  return made;
}

Error gone() { return {ErrorCode::kUnavailable, "the cable is out"}; }

/// Returns the next picture, or null after ten seconds.
std::shared_ptr<const camera::CameraFrame> take(Capture* capture) {
  return capture->frames().take_before(SteadyClock().now() + seconds(10)).value_or(nullptr);
}

/// Waits until `condition` holds, at most ten seconds.
template <typename Condition>
bool eventually(Condition condition) {
  const SteadyClock clock;
  for (const TimePoint until = clock.now() + seconds(10); clock.now() < until;) {
    if (condition()) return true;
    std::this_thread::yield();
  }
  return condition();
}

TEST(Capture, delivers_the_newest_picture_and_counts_the_skipped_ones) {
  const SteadyClock clock;
  Capture capture(
      []() -> Result<std::unique_ptr<camera::Camera>> {
        return std::unique_ptr<camera::Camera>(
            std::make_unique<ScriptedCamera>(std::deque<ScriptedCamera::Step>{frame(0), frame(1), frame(2)}));
      },
      clock);
  ASSERT_TRUE(eventually([&] { return capture.dropped() == 2; }));
  const auto newest = take(&capture);
  ASSERT_NE(newest, nullptr);
  EXPECT_EQ(newest->sequence, 2U);
  EXPECT_EQ(capture.problem(), "");
  EXPECT_EQ(capture.camera_id(), "scripted");
}

TEST(Capture, reopens_the_camera_whichever_call_fails) {
  const SteadyClock clock;
  int made = 0;  // Used by the capture thread until it has ended.
  {
    Capture capture(
        [&]() -> Result<std::unique_ptr<camera::Camera>> {
          using Steps = std::deque<ScriptedCamera::Step>;
          switch (made++) {
            case 0:
              return gone();
            case 1:
              return std::unique_ptr<camera::Camera>(std::make_unique<ScriptedCamera>(Steps{frame(1)}, gone()));
            case 2:
              return std::unique_ptr<camera::Camera>(std::make_unique<ScriptedCamera>(Steps{gone()}));
            default:
              return std::unique_ptr<camera::Camera>(std::make_unique<ScriptedCamera>(Steps{frame(3)}));
          }
        },
        clock);
    const auto first = take(&capture);
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first->sequence, 3U);
    EXPECT_EQ(capture.problem(), "");
  }
  EXPECT_EQ(made, 4);
}

TEST(Capture, reports_the_error_and_can_be_stopped_during_its_pause) {
  const SteadyClock clock;
  TimePoint began;
  {
    Capture capture([]() -> Result<std::unique_ptr<camera::Camera>> { return gone(); }, clock);
    ASSERT_TRUE(eventually([&] { return capture.problem() == "the cable is out"; }));
    began = clock.now();
  }
  EXPECT_LT(clock.now() - began, Capture::kMaxPause);
}

}  // namespace
}  // namespace cyclorama::tracker
