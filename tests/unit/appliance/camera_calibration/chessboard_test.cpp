// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/chessboard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cyclorama::camera_calibration {
namespace {

/// Four squares that meet at a place, turned by an angle, with the edges blurred and with noise.
GreyImage squares(const Eigen::Vector2d& middle, double angle_rad, double dark, double bright, double noise) {
  GreyImage picture(64, 64);
  std::mt19937 random(7);
  std::normal_distribution<double> of_a_pixel(0.0, noise);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Eigen::Vector2d at = Eigen::Vector2d(x + 0.5, y + 0.5) - middle;
      const double u = std::cos(angle_rad) * at.x() + std::sin(angle_rad) * at.y();
      const double v = std::cos(angle_rad) * at.y() - std::sin(angle_rad) * at.x();
      const double share = 0.5 + 0.5 * std::erf(u) * std::erf(v);
      *picture.at(x, y) =
          static_cast<std::uint8_t>(std::clamp(dark + share * (bright - dark) + of_a_pixel(random) + 0.5, 0.0, 255.0));
    }
  }
  return picture;
}

TEST(SharpenedCorners, finds_corners_however_they_are_turned_and_lit) {
  const Eigen::Vector2d middle(31.3, 32.8);
  for (const double angle_rad : {0.0, 0.4, 0.785, 1.2}) {
    for (const double bright : {60.0, 240.0}) {
      const auto found = sharpened_corners(squares(middle, angle_rad, 20.0, bright, 1.0), {{32.5, 31.5}}, 6);
      ASSERT_TRUE(found);
      EXPECT_NEAR((found->front() - middle).norm(), 0.0, 0.1) << angle_rad << " " << bright;
    }
  }
}

TEST(SharpenedCorners, a_corner_without_contrast_is_none) {
  const Eigen::Vector2d begun(32.5, 31.5);
  for (const double noise : {0.0, 1.0, 3.0}) {
    const auto found = sharpened_corners(squares({32.0, 32.0}, 0.3, 128.0, 128.0, noise), {begun}, 6);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->front().allFinite()) << noise << ": " << found->front().transpose();
  }
  // Overexposed: nothing is left of the squares.
  const auto white = sharpened_corners(squares({32.0, 32.0}, 0.3, 300.0, 400.0, 0.0), {begun}, 6);
  ASSERT_TRUE(white);
  EXPECT_FALSE(white->front().allFinite());
}

}  // namespace
}  // namespace cyclorama::camera_calibration
