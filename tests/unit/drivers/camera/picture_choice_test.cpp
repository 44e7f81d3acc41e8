// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/picture_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cyclorama::camera {
namespace {

constexpr std::uint32_t code(const char (&letters)[5]) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(letters[i]) << 8U * i;
  return value;
}

PictureOffer grey(int width, int height, double rate) {
  return {code("GREY"), PixelLayout::kGrey8, width, height, rate};
}
PictureOffer yuyv(int width, int height, double rate) {
  return {code("YUYV"), PixelLayout::kYuyv, width, height, rate};
}
PictureOffer mjpg(int width, int height, double rate) {
  return {code("MJPG"), PixelLayout::kJpeg, width, height, rate};
}

std::string chosen(std::vector<PictureOffer> offers, const PicturePreference& preferred = {}) {
  const auto first = choose_picture(offers, preferred);
  EXPECT_TRUE(first.has_value());
  // The order in which a driver lists its offers must not matter.
  std::mt19937 random(1);
  const std::string text = describe(offers[*first]);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(offers.begin(), offers.end(), random);
    EXPECT_EQ(describe(offers[*choose_picture(offers, preferred)]), text);
  }
  return text;
}

TEST(PictureChoice, takes_the_cheapest_pixel_format_that_suffices) {
  EXPECT_EQ(chosen({mjpg(640, 480, 30), yuyv(640, 480, 30), grey(640, 480, 30)}), "640x480 GREY at 30 per second");
  const PictureOffer planar{code("NV12"), PixelLayout::kPlanarYuv, 640, 480, 30};
  EXPECT_EQ(chosen({planar, grey(640, 480, 30)}), "640x480 GREY at 30 per second");
  EXPECT_EQ(chosen({planar, yuyv(640, 480, 30)}), "640x480 NV12 at 30 per second");
  EXPECT_EQ(chosen({mjpg(640, 480, 30), yuyv(640, 480, 30)}), "640x480 YUYV at 30 per second");
}

TEST(PictureChoice, takes_colours_if_wanted_and_available) {
  PictureOffer coloured = yuyv(640, 480, 5);
  coloured.is_coloured = true;
  PicturePreference preferred;
  EXPECT_EQ(chosen({coloured, grey(640, 480, 30)}, preferred), "640x480 GREY at 30 per second");
  preferred.is_coloured = true;
  EXPECT_EQ(chosen({coloured, grey(640, 480, 30)}, preferred), "640x480 YUYV at 5 per second");
  EXPECT_EQ(chosen({grey(640, 480, 30), grey(640, 480, 15)}, preferred), "640x480 GREY at 30 per second");
}

TEST(PictureChoice, takes_jpeg_if_only_that_reaches_the_rate) {
  const PicturePreference preferred{1280, 720, 30.0};
  EXPECT_EQ(chosen({yuyv(1280, 720, 10), mjpg(1280, 720, 30)}, preferred), "1280x720 MJPG at 30 per second");
  EXPECT_EQ(chosen({yuyv(640, 480, 15), mjpg(640, 480, 30)}), "640x480 MJPG at 30 per second");
}

TEST(PictureChoice, prefers_the_wanted_rate_to_a_faster_one) {
  EXPECT_EQ(chosen({grey(640, 480, 120), grey(640, 480, 30), grey(640, 480, 15)}), "640x480 GREY at 30 per second");
  EXPECT_EQ(chosen({grey(640, 480, 60), grey(640, 480, 15)}), "640x480 GREY at 60 per second");
  EXPECT_EQ(chosen({grey(640, 480, 30000.0 / 1001), grey(640, 480, 60)}), "640x480 GREY at 29.97 per second");
}

TEST(PictureChoice, takes_the_nearest_size_preferring_a_larger_one) {
  EXPECT_EQ(chosen({grey(320, 240, 30), grey(800, 600, 30), grey(1920, 1080, 30)}), "800x600 GREY at 30 per second");
  EXPECT_EQ(chosen({grey(320, 240, 30), grey(1280, 960, 30)}), "1280x960 GREY at 30 per second");
  EXPECT_EQ(chosen({grey(640, 360, 30), grey(640, 480, 30)}), "640x480 GREY at 30 per second");
  EXPECT_EQ(chosen({grey(640, 480, 5), grey(800, 600, 30)}), "800x600 GREY at 30 per second");
}

TEST(PictureChoice, takes_what_is_available) {
  EXPECT_EQ(chosen({mjpg(160, 120, 5)}), "160x120 MJPG at 5 per second");
  EXPECT_EQ(chosen({yuyv(4096, 4096, 0)}), "4096x4096 YUYV");
}

TEST(PictureChoice, refuses_an_empty_list_and_invalid_sizes) {
  EXPECT_EQ(choose_picture({}, {}).error().code(), ErrorCode::kNotFound);
  EXPECT_FALSE(choose_picture({grey(0, 480, 30), grey(640, -1, 30)}, {}).has_value());
}

TEST(FourccText, never_prints_control_characters) {
  EXPECT_EQ(fourcc_text(code("NV12")), "NV12");
  EXPECT_EQ(fourcc_text(code("Y16 ")), "Y16");
  EXPECT_EQ(fourcc_text(0), "????");
  EXPECT_EQ(fourcc_text(0x07ff1b0aU).size(), 4U);
}

}  // namespace
}  // namespace cyclorama::camera
