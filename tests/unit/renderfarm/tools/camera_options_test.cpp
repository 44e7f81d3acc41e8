// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/camera_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace cyclorama::tools {
namespace {

constexpr double kPi = std::numbers::pi;

Result<Projection> parsed(std::vector<std::string> arguments) {
  CLI::App app;
  CameraOptions options;
  add_camera_options(&app, &options);
  std::reverse(arguments.begin(), arguments.end());
  app.parse(arguments);
  return projection_of(options, 800, 400);
}

std::string refusal(std::vector<std::string> arguments) {
  const auto projection = parsed(std::move(arguments));
  return projection ? std::string() : projection.error().message();
}

TEST(CameraOptions, default_to_a_full_panorama_of_square_pixels_for_one_eye) {
  const auto projection = parsed({});
  ASSERT_TRUE(projection.has_value());
  const auto panorama = std::get<Panorama>(projection->shape);
  EXPECT_DOUBLE_EQ(panorama.azimuth_span_rad, 2.0 * kPi);
  EXPECT_DOUBLE_EQ(panorama.tan_elevation_top - panorama.tan_elevation_bottom, kPi);
  EXPECT_EQ(projection->viewing.eyes, Eyes::kMono);
  EXPECT_DOUBLE_EQ(std::get<Panorama>(parsed({"--azimuth-deg", "90"})->shape).azimuth_span_rad, 0.5 * kPi);
}

TEST(CameraOptions, give_each_camera_its_field_and_tilt) {
  const auto perspective = std::get<Perspective>(parsed({"--camera", "perspective", "--tilt-deg", "45"})->shape);
  EXPECT_NEAR(perspective.tan_right, 1.0, 1e-12);
  EXPECT_NEAR(perspective.tan_top, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(perspective.tilt_rad, 0.25 * kPi);
  const auto fisheye = std::get<Fisheye>(parsed({"--camera", "fisheye", "--field-deg", "360"})->shape);
  EXPECT_DOUBLE_EQ(fisheye.field_rad, 2.0 * kPi);
  EXPECT_DOUBLE_EQ(std::get<Fisheye>(parsed({"--camera", "fisheye"})->shape).field_rad, kPi);
  EXPECT_DOUBLE_EQ(std::get<Equirectangular>(parsed({"--camera", "equirectangular"})->shape).elevation_top_rad,
                   0.5 * kPi);
}

TEST(CameraOptions, require_a_screen_for_two_eyes) {
  EXPECT_THAT(refusal({"--stereo", "left"}), testing::HasSubstr("--screen-distance-m"));
  const auto both = parsed({"--stereo", "over-under", "--screen-radius-m", "4", "--eye-distance-m", "0.07"});
  ASSERT_TRUE(both.has_value());
  EXPECT_EQ(both->viewing.eyes, Eyes::kOverUnder);
  EXPECT_EQ(both->viewing.screen_distance_m, 4.0);
  EXPECT_EQ(both->viewing.eye_distance_m, 0.07);
  EXPECT_EQ(both->height_px(), 800);
}

TEST(CameraOptions, refuse_conflicting_options_in_one_sentence) {
  EXPECT_THAT(refusal({"--tilt-deg", "10"}), testing::HasSubstr("--tilt-deg"));
  EXPECT_THAT(refusal({"--camera", "perspective", "--field-deg", "180"}), testing::HasSubstr("--field-deg"));
  EXPECT_THAT(refusal({"--camera", "perspective", "--field-deg", "nan"}), testing::HasSubstr("--field-deg"));
  EXPECT_THAT(refusal({"--camera", "fisheye", "--field-deg", "361"}), testing::HasSubstr("field_rad"));
  EXPECT_THAT(refusal({"--stereo", "left", "--screen-distance-m", "0.01"}), testing::HasSubstr("screen_distance_m"));
}

}  // namespace
}  // namespace cyclorama::tools
