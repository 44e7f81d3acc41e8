// SPDX-License-Identifier: Apache-2.0
#include "drivers/devices/make_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doubles/fake_clock.h"

namespace cyclorama::devices {
namespace {

using testing::HasSubstr;

Error error_of(std::string_view spec) {
  const FakeClock clock;
  auto camera = make_camera(spec, clock);
  EXPECT_FALSE(camera.has_value()) << spec;
  return camera ? Error(ErrorCode::kSystem, "it was made") : camera.error();
}

TEST(MakeCamera, lists_the_kinds_for_an_unknown_one) {
  for (const char* spec : {"", ":", "webcam", "v4l3:/dev/video0", "FILE:x", "\xff\x01"}) {
    const Error error = error_of(spec);
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << spec;
    EXPECT_THAT(error.message(), HasSubstr("the kinds are v4l2:, libcamera:, file:, simulated:"));
  }
}

TEST(MakeCamera, distinguishes_an_invalid_line_from_a_missing_file) {
  EXPECT_EQ(error_of("file:").code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of("file:?loop=no").code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of("file:/nowhere/at/all.png").code(), ErrorCode::kNotFound);
  EXPECT_EQ(error_of("simulated:/nowhere/at/all.toml").code(), ErrorCode::kNotFound);
}

TEST(MakeCamera, refuses_unknown_options) {
  EXPECT_THAT(error_of("file:x.png?rate=3").message(), HasSubstr("frames_per_second=N and loop=yes or loop=no"));
  EXPECT_THAT(error_of("file:x.png?frames_per_second=fast").message(), HasSubstr("must be a number"));
  for (const char* rate : {"0", "-1", "nan", "inf", "1e9"}) {
    EXPECT_EQ(error_of(std::string("file:x.png?frames_per_second=") + rate).code(), ErrorCode::kInvalidArgument)
        << rate;
  }
}

TEST(MakeCamera, refuses_wrong_options_of_a_real_camera_before_searching_for_it) {
  for (const char* line : {"v4l2:?width_px=0", "v4l2:?height_px=nan", "v4l2:?frames_per_second=0",
                           "v4l2:?exposure_ms=-1", "v4l2:?memory=disk", "v4l2:?colour=maybe", "v4l2:usb-1?=&==",
                           "libcamera:?memory=dma_buf", "libcamera:?width_px=9999", "simulated:?width_px=640"}) {
    EXPECT_EQ(error_of(line).code(), ErrorCode::kInvalidArgument) << line;
  }
}

TEST(MakeCamera, reports_a_missing_real_camera) {
  for (const char* line :
       {"v4l2:no-such-port", "v4l2:/dev/no-such-camera", "v4l2:no-such-port?width_px=640&exposure_ms=0"}) {
    EXPECT_EQ(error_of(line).code(), ErrorCode::kNotFound) << line;
  }
  EXPECT_EQ(error_of("v4l2:/dev/null").code(), ErrorCode::kNotFound);
}

TEST(MakeCamera, makes_the_demos_camera_from_one_word) {
  const FakeClock clock;
  auto camera = make_camera("simulated", clock);
  ASSERT_TRUE(camera.has_value()) << camera.error().message();
  ASSERT_TRUE((*camera)->start().has_value());
  const auto frame = (*camera)->next_frame(clock.now() + std::chrono::seconds(1));
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ((*frame)->pixels.width(), 640);
}

}  // namespace
}  // namespace cyclorama::devices
