// SPDX-License-Identifier: Apache-2.0
// Every call of the camera to the kernel fails once, in every way: nothing may leak, the error must be reported, and
// the next camera must deliver. Modelled on SQLite's anomaly tests: the failing call's number increases until no call
// fails any more.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <set>
#include <system_error>

#include "drivers/camera/v4l2/v4l2_camera.h"
#include "tests/doubles/fake_video/fake_video.h"

namespace cyclorama::camera {
namespace {

using std::chrono::seconds;

/// Uses a camera as a tracker does: opens it, takes pictures, closes it. Returns the first Error, if any.
Status visit(const V4l2CameraOptions& options, const Clock& clock) {
  TRY_ASSIGN(const std::unique_ptr<Camera> camera, V4l2Camera::open("usb-0000:00:14.0-2", options, clock));
  TRY(camera->start());
  for (int i = 0; i < 12; ++i) TRY(camera->next_frame(clock.now() + seconds(1)));
  camera->stop();
  TRY(camera->start());
  TRY(camera->next_frame(clock.now() + seconds(1)));
  return Done{};
}

struct Kind {
  FakeVideoDevice device;
  BufferMemory memory = BufferMemory::kMapped;
};

class V4l2Faults : public testing::TestWithParam<int> {
 protected:
  static Kind kind(int number) {
    Kind kind;
    kind.device = usb_camera();
    // Small pictures, since there are thousands of them.
    for (FakeFormat& format : kind.device.formats) format.sizes = {{64, 48, {30.0}}};
    if (number == 1) kind.memory = BufferMemory::kDmaBuf;
    if (number == 2) {
      kind.device = grey_camera();
      kind.device.port = "usb-0000:00:14.0-2";
      kind.device.is_grabber = true;
    }
    return kind;
  }
};

TEST_P(V4l2Faults, leak_nothing_and_the_camera_recovers_whichever_call_fails) {
  std::set<std::string> failed_calls;
  int survived = 0;
  int said = 0;
  for (const int error : {EIO, ENODEV, EBUSY, EINVAL, ENOMEM, ENOSPC, EINTR, EAGAIN, EACCES, ENOTTY, EPIPE}) {
    for (int nth = 1;; ++nth) {
      ASSERT_LT(nth, 1000);
      const Kind made = kind(GetParam());
      V4l2CameraOptions options;
      options.memory = made.memory;
      options.preferred = {64, 48, 30.0};
      FakeClock clock;
      FakeVideo video({made.device}, &clock);
      video.fail_nth(nth, error);
      const Status visited = visit(options, clock);
      const std::string where =
          std::generic_category().message(error) + " from call " + std::to_string(nth) + ", " + video.failed_call();
      EXPECT_EQ(video.held(), 0U) << where;
      if (!video.was_fault_met()) {
        EXPECT_TRUE(visited.has_value());
        break;
      }
      failed_calls.insert(video.failed_call());
      if (!visited) {
        EXPECT_FALSE(visited.error().message().empty()) << where;
        ++said;
      } else {
        ++survived;
      }
      if (error == EINTR) {
        // Every request is retried.
        EXPECT_TRUE(visited.has_value() || video.failed_call() == "open" || video.failed_call() == "mmap") << where;
      }
      const Status again = visit(options, clock);
      EXPECT_TRUE(again.has_value()) << where << ", then " << (again ? "" : again.error().message());
      EXPECT_EQ(video.held(), 0U) << where;
    }
  }
  RecordProperty("survived", survived);
  RecordProperty("said", said);
  std::printf("%d faults survived unseen, %d said; calls that failed:", survived, said);
  for (const std::string& call : failed_calls) std::printf(" %s", call.c_str());
  std::printf("\n");
  for (const char* call : {"open", "mmap", "ppoll", "VIDIOC_QUERYCAP", "VIDIOC_S_FMT", "VIDIOC_REQBUFS", "VIDIOC_QBUF",
                           "VIDIOC_DQBUF", "VIDIOC_STREAMON"}) {
    EXPECT_EQ(failed_calls.count(call), 1U) << call;
  }
}

std::string name_of_kind(const testing::TestParamInfo<int>& kind) {
  constexpr std::array kNames{"usb", "usb_dma_buf", "grabber"};
  return kNames.at(static_cast<std::size_t>(kind.param));
}
INSTANTIATE_TEST_SUITE_P(EveryDevice, V4l2Faults, testing::Values(0, 1, 2), name_of_kind);

TEST(V4l2Unplugged, leaks_nothing_at_any_moment) {
  for (int pictures = 0; pictures < 5; ++pictures) {
    FakeClock clock;
    FakeVideo video({usb_camera()}, &clock);
    {
      auto camera = V4l2Camera::open("", {}, clock);
      ASSERT_TRUE(camera.has_value());
      if (pictures > 0) {
        ASSERT_TRUE((*camera)->start().has_value());
      }
      for (int i = 1; i < pictures; ++i) ASSERT_TRUE((*camera)->next_frame(clock.now() + seconds(1)).has_value());
      video.unplug(0);
      if (pictures == 0) {
        EXPECT_EQ((*camera)->start().error().code(), ErrorCode::kUnavailable);
      }
      EXPECT_EQ((*camera)->next_frame(clock.now() + seconds(1)).error().code(), ErrorCode::kUnavailable);
    }
    EXPECT_EQ(video.held(), 0U);
  }
}

}  // namespace
}  // namespace cyclorama::camera
