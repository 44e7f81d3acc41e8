// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/projector_corners.h"

#include <gmock/gmock.h>

#include "tests/data_sets/lit_wall.h"

namespace cyclorama::camera_calibration {
namespace {

/// Returns a wall seen at an angle, so that the map is not linear.
LitWall slanted_wall() {
  LitWall wall;
  wall.projector_pixel_at = [](double u, double v) {
    const double depth = 1.0 + 0.001 * u + 0.0005 * v;
    return Eigen::Vector2d(0.7 * u / depth + 3.0, 0.7 * v / depth + 2.0);
  };
  return wall;
}

structured_light::Decoded decoded_of(const LitWall& wall) {
  const auto set = structured_light::structured_light({.width_px = 128, .height_px = 96});
  CHECK(set.has_value());
  auto decoded = wall.decoder(*set).finish();
  CHECK(decoded.has_value());
  return *std::move(decoded);
}

TEST(ProjectorPixelAt, interpolates_to_some_hundredths_of_a_pixel) {
  const LitWall wall = slanted_wall();
  const structured_light::Decoded decoded = decoded_of(wall);
  for (const Eigen::Vector2d& at :
       {Eigen::Vector2d(40.0, 40.0), Eigen::Vector2d(83.27, 61.9), Eigen::Vector2d(120.5, 90.01)}) {
    const auto position = projector_pixel_at(decoded, at, 12.0);
    ASSERT_TRUE(position);
    EXPECT_LT((*position - wall.projector_pixel_at(at.x(), at.y())).norm(), 0.02);
  }
}

TEST(ProjectorPixelAt, is_robust_against_outliers) {
  const LitWall wall = slanted_wall();
  structured_light::Decoded decoded = decoded_of(wall);
  // A tenth of the pixels are shifted in the same direction.
  for (int y = 30; y < 50; ++y) {
    for (int x = 30; x < 50; x += 10) decoded.position_px.at(x, y)[0] += 40.0f;
  }
  const Eigen::Vector2d at(40.0, 40.0);
  const auto position = projector_pixel_at(decoded, at, 12.0);
  ASSERT_TRUE(position);
  EXPECT_LT((*position - wall.projector_pixel_at(40.0, 40.0)).norm(), 0.03);
}

TEST(ProjectorPixelAt, is_empty_where_little_is_decoded) {
  structured_light::Decoded decoded = decoded_of(slanted_wall());
  EXPECT_FALSE(projector_pixel_at(decoded, {-50.0, 40.0}, 12.0));
  EXPECT_FALSE(projector_pixel_at(decoded, {1e300, 40.0}, 12.0));
  EXPECT_FALSE(projector_pixel_at(decoded, {std::nan(""), 40.0}, 12.0));
  // A single line of pixels gives no information across it.
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      if (y != 40) *decoded.fate.at(x, y) = structured_light::PixelFate::kDark;
    }
  }
  EXPECT_FALSE(projector_pixel_at(decoded, {40.0, 40.5}, 40.0));
}

}  // namespace
}  // namespace cyclorama::camera_calibration
