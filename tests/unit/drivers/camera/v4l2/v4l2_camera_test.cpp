// SPDX-License-Identifier: Apache-2.0
// Requests of the V4L2 camera to a device, and its errors when the device is lost, held, silent or faulty.
#include "drivers/camera/v4l2/v4l2_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/doubles/fake_video/fake_video.h"

namespace cyclorama::camera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::Not;

struct Started {
  FakeClock clock;
  FakeVideo video;
  std::unique_ptr<Camera> camera;

  explicit Started(FakeVideoDevice device, const V4l2CameraOptions& options = {}) : video({std::move(device)}, &clock) {
    auto opened = V4l2Camera::open("", options, clock);
    EXPECT_TRUE(opened.has_value()) << opened.error().message();
    camera = *std::move(opened);
    const auto started = camera->start();
    EXPECT_TRUE(started.has_value()) << started.error().message();
  }
  Result<std::shared_ptr<const CameraFrame>> next() { return camera->next_frame(clock.now() + seconds(1)); }
};

/// Returns whether the picture is exactly the fake's picture n.
bool is_fake_picture(const GreyImage& picture, std::uint32_t sequence) {
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (*picture.at(x, y) != fake_level(sequence, x, y)) return false;
    }
  }
  return true;
}

TEST(V4l2Camera, reads_every_layout_exactly) {
  for (const std::uint32_t fourcc :
       {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY, V4L2_PIX_FMT_Y16}) {
    for (const std::uint32_t padding : {0U, 32U}) {
      FakeVideoDevice device;
      device.formats = {{fourcc, {{}}}};
      device.row_padding = padding;
      Started started(device);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const auto frame = started.next();
        ASSERT_TRUE(frame.has_value()) << fourcc_text(fourcc) << ": " << frame.error().message();
        EXPECT_TRUE(is_fake_picture((*frame)->pixels, i)) << fourcc_text(fourcc) << " " << i;
      }
    }
  }
}

TEST(V4l2Camera, decodes_jpeg_if_nothing_else_is_fast_enough) {
  V4l2CameraOptions options;
  options.preferred = {1280, 720, 30.0};
  Started started(usb_camera(), options);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const auto frame = started.next();
    ASSERT_TRUE(frame.has_value()) << frame.error().message();
    EXPECT_EQ((*frame)->pixels.width(), 1280);
    EXPECT_NEAR(*(*frame)->pixels.at(600, 300), fake_level(i, 0, 0), 2);
  }
}

TEST(V4l2Camera, takes_the_nearest_size_of_a_range) {
  V4l2CameraOptions options;
  options.preferred = {637, 485, 55.0};
  Started started(grey_camera(), options);
  const auto first = started.next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ((*first)->pixels.width(), 640);
  EXPECT_EQ((*first)->pixels.height(), 488);
  const auto second = started.next();
  ASSERT_TRUE(second.has_value());
  EXPECT_NEAR(to_milliseconds((*second)->captured_at - (*first)->captured_at), 1000.0 / 55.0, 0.01);
}

TEST(V4l2Camera, sets_a_short_constant_exposure) {
  Started started(usb_camera());
  const auto& controls = started.video.device(0).controls;
  EXPECT_EQ(controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(controls.at(V4L2_CID_EXPOSURE_AUTO_PRIORITY).value, 0);
  EXPECT_EQ(controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
}

TEST(V4l2Camera, sets_the_exposure_that_is_nearest_in_the_cameras_steps) {
  // 5 ms are asked for, 50 of its units.
  for (const auto& [step, nearest] : {std::pair(20L, 41L), std::pair(35L, 36L), std::pair(28L, 57L)}) {
    FakeVideoDevice device = usb_camera();
    device.controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 5001, step, 1};
    Started started(device);
    EXPECT_EQ(started.video.device(0).controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, nearest) << step;
  }
}

TEST(V4l2Camera, reads_colours_on_request_and_fixes_the_white_balance) {
  FakeVideoDevice device = usb_camera();
  device.controls[V4L2_CID_AUTO_WHITE_BALANCE] = {0, 1, 1, 1};
  V4l2CameraOptions options;
  options.gain = GainRule::kHeld;
  {
    Started plain(device, options);
    const auto frame = plain.next();
    ASSERT_TRUE(frame.has_value()) << frame.error().message();
    EXPECT_TRUE((*frame)->colour.empty());
  }
  options.preferred.is_coloured = true;
  Started started(device, options);
  EXPECT_EQ(started.video.device(0).controls.at(V4L2_CID_AUTO_WHITE_BALANCE).value, 0);
  const auto frame = started.next();
  ASSERT_TRUE(frame.has_value()) << frame.error().message();
  EXPECT_TRUE(is_fake_picture((*frame)->pixels, 0));
  ASSERT_EQ((*frame)->colour.width(), 640);
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(31, 17), std::pair(639, 479)}) {
    // The fake's grey ranges from 16 to 235.
    const double expected = std::clamp((fake_level(0, x, y) - 16.0) * 255.0 / 219.0, 0.0, 255.0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR((*frame)->colour.at(x, y)[c], expected, 0.51);
  }
}

TEST(V4l2Camera, leaves_exposure_to_the_device_if_configured) {
  V4l2CameraOptions options;
  options.exposure = Duration::zero();
  Started started(usb_camera(), options);
  EXPECT_EQ(started.video.device(0).controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_APERTURE_PRIORITY);
  EXPECT_EQ(started.video.device(0).controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 250);
}

TEST(V4l2Camera, adapts_to_the_light_by_the_steps_of_its_gain) {
  FakeVideoDevice device = usb_camera();
  Started started(device);
  long max = 0;
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(started.next().has_value());
    max = std::max(max, started.video.device(0).controls.at(V4L2_CID_GAIN).value);
  }
  // The fake's pictures are bright enough at any gain, so the gain must not change.
  EXPECT_EQ(max, 0);
}

TEST(V4l2Camera, uses_the_kernels_time_stamp) {
  for (const bool is_start : {true, false}) {
    FakeVideoDevice device = usb_camera();
    device.exposure = milliseconds(5);
    device.stamp_flags =
        V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (is_start ? V4L2_BUF_FLAG_TSTAMP_SRC_SOE : V4L2_BUF_FLAG_TSTAMP_SRC_EOF);
    Started started(device);
    const auto frame = started.next();
    ASSERT_TRUE(frame.has_value());
    // The fake's time advances only during waits, so delivery takes no time.
    EXPECT_EQ(started.clock.now() - (*frame)->captured_at, milliseconds(5)) << is_start;
  }
  FakeVideoDevice device = usb_camera();
  device.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  Started started(device);
  const auto frame = started.next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ((*frame)->captured_at, started.clock.now());
}

TEST(V4l2Camera, fails_when_unplugged_and_works_again_at_the_same_port) {
  Started started(usb_camera());
  ASSERT_TRUE(started.next().has_value());
  const std::string id = started.camera->id();
  started.video.unplug(0);
  for (int again = 0; again < 2; ++again) {
    const auto gone = started.next();
    ASSERT_FALSE(gone.has_value());
    EXPECT_EQ(gone.error().code(), ErrorCode::kUnavailable);
    EXPECT_THAT(gone.error().message(), HasSubstr("unplugged?"));
  }
  EXPECT_EQ(started.camera->start().error().code(), ErrorCode::kUnavailable);
  const V4l2CameraOptions options;
  started.camera.reset();
  EXPECT_EQ(started.video.held(), 0U);
  EXPECT_EQ(V4l2Camera::open("usb-0000:00:14.0-2", options, started.clock).error().code(), ErrorCode::kNotFound);
  // The kernel assigns another number; the port stays the same.
  started.video.device(0).path = "/dev/video9";
  started.video.plug(0);
  auto again = V4l2Camera::open("usb-0000:00:14.0-2", options, started.clock);
  ASSERT_TRUE(again.has_value()) << again.error().message();
  EXPECT_EQ((*again)->id(), id);
  ASSERT_TRUE((*again)->start().has_value());
  EXPECT_TRUE((*again)->next_frame(started.clock.now() + seconds(1)).has_value());
}

TEST(V4l2Camera, reports_another_programs_use_and_starts_when_it_ends) {
  FakeClock clock;
  FakeVideo video({usb_camera()}, &clock);
  video.set_taken(0, true);
  auto camera = V4l2Camera::open("", {}, clock);
  ASSERT_TRUE(camera.has_value()) << camera.error().message();
  const auto busy = (*camera)->start();
  ASSERT_FALSE(busy.has_value());
  EXPECT_EQ(busy.error().code(), ErrorCode::kBusy);
  EXPECT_THAT(busy.error().message(), HasSubstr("fuser"));
  video.set_taken(0, false);
  ASSERT_TRUE((*camera)->start().has_value());
  EXPECT_TRUE((*camera)->next_frame(clock.now() + seconds(1)).has_value());
}

TEST(V4l2Camera, locks_the_device_and_releases_it_at_stop) {
  Started started(usb_camera());
  auto second = V4l2Camera::open("", {}, started.clock);
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ((*second)->start().error().code(), ErrorCode::kBusy);
  started.camera->stop();
  EXPECT_TRUE((*second)->start().has_value());
}

TEST(V4l2Camera, times_out_when_the_stream_stalls_and_continues_with_it) {
  Started started(usb_camera());
  ASSERT_TRUE(started.next().has_value());
  started.video.set_stalled(0, true);
  const TimePoint deadline = started.clock.now() + milliseconds(200);
  EXPECT_EQ(started.camera->next_frame(deadline).error().code(), ErrorCode::kTimedOut);
  EXPECT_EQ(started.clock.now(), deadline);
  started.video.set_stalled(0, false);
  EXPECT_TRUE(started.next().has_value());
}

TEST(V4l2Camera, drops_damaged_pictures) {
  Started started(usb_camera());
  const auto first = started.next();
  ASSERT_TRUE(first.has_value());
  started.video.damage(0, 3);
  const auto after = started.next();
  ASSERT_TRUE(after.has_value()) << after.error().message();
  EXPECT_EQ((*after)->sequence, (*first)->sequence + 4);
  started.video.shorten(0, 2);
  const auto whole = started.next();
  ASSERT_TRUE(whole.has_value()) << whole.error().message();
  EXPECT_EQ((*whole)->sequence, (*after)->sequence + 3);
}

TEST(V4l2Camera, reports_that_all_pictures_are_damaged) {
  Started started(usb_camera());
  started.video.damage(0, 1000);
  const auto none = started.next();
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code(), ErrorCode::kTimedOut);
  EXPECT_THAT(none.error().message(), HasSubstr("damaged"));
}

TEST(V4l2Camera, fails_when_the_signals_format_changes) {
  FakeVideoDevice grabber = grey_camera();
  grabber.is_grabber = true;
  Started started(grabber);
  ASSERT_TRUE(started.next().has_value());
  started.video.change_source(0);
  const auto changed = started.next();
  ASSERT_FALSE(changed.has_value());
  EXPECT_EQ(changed.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(changed.error().message(), HasSubstr("another shape"));
  EXPECT_EQ(started.video.held(), 1U) << "only the device's file";
}

TEST(V4l2Camera, waits_for_a_grabbers_signal) {
  FakeClock clock;
  FakeVideoDevice grabber = grey_camera();
  grabber.is_grabber = true;
  grabber.has_signal = false;
  FakeVideo video({grabber}, &clock);
  auto camera = V4l2Camera::open("", {}, clock);
  ASSERT_TRUE(camera.has_value());
  const auto dark = (*camera)->start();
  ASSERT_FALSE(dark.has_value());
  EXPECT_THAT(dark.error().message(), HasSubstr("no usable signal"));
}

TEST(V4l2Camera, works_without_features_that_cheap_devices_lack) {
  FakeVideoDevice plain;
  plain.formats = {{V4L2_PIX_FMT_YUYV, {}}};
  plain.exports_dma_bufs = false;
  Started started(plain);
  EXPECT_TRUE(started.next().has_value());
  started.camera->stop();
  V4l2CameraOptions options;
  options.memory = BufferMemory::kDmaBuf;
  auto exporting = V4l2Camera::open("", options, started.clock);
  ASSERT_TRUE(exporting.has_value());
  EXPECT_THAT((*exporting)->start().error().message(), HasSubstr("leave out memory=dma_buf"));
}

TEST(V4l2Camera, names_the_available_devices_in_an_error) {
  FakeClock clock;
  FakeVideoDevice metadata = usb_camera();
  metadata.path = "/dev/video1";
  metadata.can = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  FakeVideoDevice twin = usb_camera();
  twin.path = "/dev/video3";
  FakeVideoDevice mosaic = usb_camera();
  mosaic.path = "/dev/video4";
  mosaic.port = "platform:isp";
  mosaic.formats = {{V4L2_PIX_FMT_SRGGB8, {{}}}};
  FakeVideo video({usb_camera(), metadata, grey_camera(), twin, mosaic}, &clock);
  const auto absent = V4l2Camera::open("usb-9", {}, clock);
  ASSERT_FALSE(absent.has_value());
  EXPECT_EQ(absent.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(absent.error().message(),
              HasSubstr("there are cameras at usb-0000:00:14.0-2, usb-0000:00:14.0-7, usb-0000:00:14.0-2+1"));
  EXPECT_EQ((*V4l2Camera::open("/dev/video3", {}, clock))->id(), "v4l2:usb-0000:00:14.0-2+1");
  EXPECT_EQ((*V4l2Camera::open("usb-0000:00:14.0-2+1", {}, clock))->id(), "v4l2:usb-0000:00:14.0-2+1");
  EXPECT_EQ(V4l2Camera::open("/dev/video1", {}, clock).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(V4l2Camera::open("platform:isp", {}, clock).error().code(), ErrorCode::kNotFound);

  const std::vector<ListedCamera> listed = list_v4l2_cameras();
  ASSERT_EQ(listed.size(), 4U);
  EXPECT_EQ(listed[0].spec, "v4l2:usb-0000:00:14.0-2");
  EXPECT_EQ(listed[0].sends, "640x480 YUYV at 30 per second");
  EXPECT_EQ(listed[1].sends, "640x480 GREY at 30 per second");
  EXPECT_THAT(listed[3].problem, HasSubstr("no pixels that can be read"));
  EXPECT_EQ(video.held(), 0U);
}

TEST(V4l2Camera, lists_devices_that_it_may_not_open_and_why) {
  FakeClock clock;
  FakeVideo video({usb_camera()}, &clock);
  video.fail("open", EACCES);
  const std::vector<ListedCamera> listed = list_v4l2_cameras();
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_THAT(listed[0].problem, HasSubstr("group 'video'"));
}

}  // namespace
}  // namespace cyclorama::camera
