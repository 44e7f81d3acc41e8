// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/projector_corners.h"

#include <gmock/gmock.h>

#include "tests/doubles/lit_wall.h"

namespace cyclorama {
namespace {

/// Seen at an angle: no straight line's map.
LitWall slanted_wall() {
  LitWall wall;
  wall.projector_place = [](double u, double v) {
    const double depth = 1.0 + 0.001 * u + 0.0005 * v;
    return Eigen::Vector2d(0.7 * u / depth + 3.0, 0.7 * v / depth + 2.0);
  };
  return wall;
}

Decoded decoded_of(const LitWall& wall) {
  const auto set = structured_light({.width_px = 128, .height_px = 96});
  CHECK(set.has_value());
  auto decoded = wall.decoder(*set).finish();
  CHECK(decoded.has_value());
  return *std::move(decoded);
}

TEST(ProjectorPlace, is_told_to_some_hundredths_between_the_pixels) {
  const LitWall wall = slanted_wall();
  const Decoded decoded = decoded_of(wall);
  for (const Eigen::Vector2d& at :
       {Eigen::Vector2d(40.0, 40.0), Eigen::Vector2d(83.27, 61.9), Eigen::Vector2d(120.5, 90.01)}) {
    const auto place = projector_place(decoded, at, 12.0);
    ASSERT_TRUE(place);
    EXPECT_LT((*place - wall.projector_place(at.x(), at.y())).norm(), 0.02);
  }
}

TEST(ProjectorPlace, is_not_moved_by_what_is_wrong) {
  const LitWall wall = slanted_wall();
  Decoded decoded = decoded_of(wall);
  // A tenth of the pixels, all in the same direction.
  for (int y = 30; y < 50; ++y) {
    for (int x = 30; x < 50; x += 10) decoded.position_px.at(x, y)[0] += 40.0f;
  }
  const Eigen::Vector2d at(40.0, 40.0);
  const auto place = projector_place(decoded, at, 12.0);
  ASSERT_TRUE(place);
  EXPECT_LT((*place - wall.projector_place(40.0, 40.0)).norm(), 0.03);
}

TEST(ProjectorPlace, is_unknown_where_little_is_decoded) {
  Decoded decoded = decoded_of(slanted_wall());
  EXPECT_FALSE(projector_place(decoded, {-50.0, 40.0}, 12.0));
  EXPECT_FALSE(projector_place(decoded, {1e300, 40.0}, 12.0));
  EXPECT_FALSE(projector_place(decoded, {std::nan(""), 40.0}, 12.0));
  // A single line of pixels says nothing across it.
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      if (y != 40) *decoded.fate.at(x, y) = PixelFate::kDark;
    }
  }
  EXPECT_FALSE(projector_place(decoded, {40.0, 40.5}, 40.0));
}

}  // namespace
}  // namespace cyclorama
