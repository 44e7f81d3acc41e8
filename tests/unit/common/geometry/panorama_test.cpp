// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/panorama.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace cyclorama {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTiny = 1e-9;  // Pixels or metres; rounding of about ten operations near 1e4.

Panorama half_circle() { return {2048, 640, kPi, 0.4, -0.6}; }

TEST(Panorama, looks_ahead_in_the_middle_and_right_on_the_right) {
  const Panorama panorama = half_circle();
  const Eigen::Vector3d ahead = panorama.direction_at({1024.0, 0.4 / 1.0 * 640.0});
  EXPECT_LT((ahead - Eigen::Vector3d(0, 0, -1)).norm(), kTiny);
  EXPECT_LT((panorama.direction_at({2048.0, 256.0}) - Eigen::Vector3d(1, 0, 0)).norm(), kTiny);
  EXPECT_NEAR(panorama.direction_at({0.0, 0.0}).y(), 0.4, kTiny);
  EXPECT_NEAR(panorama.direction_at({0.0, 640.0}).y(), -0.6, kTiny);
}

TEST(Panorama, pixel_of_is_the_inverse_of_direction_at_for_any_length) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    Panorama panorama{1 + static_cast<int>(unit(random) * 16383), 1 + static_cast<int>(unit(random) * 16383),
                      0.01 + unit(random) * (2.0 * kPi - 0.02), unit(random) * 3.0, -0.01 - unit(random) * 3.0};
    const PanoramaPixel p{(0.001 + 0.998 * unit(random)) * panorama.width_px, unit(random) * panorama.height_px};
    const PanoramaPixel back = panorama.pixel_of((0.01 + 100.0 * unit(random)) * panorama.direction_at(p));
    EXPECT_NEAR(back.u, p.u, 1e-6);
    EXPECT_NEAR(back.v, p.v, 1e-6);
  }
}

TEST(Panorama, has_no_pixel_for_straight_up) {
  EXPECT_TRUE(std::isinf(half_circle().pixel_of(Eigen::Vector3d::UnitY()).v));
}

TEST(Panorama, validate_refuses_every_invalid_field) {
  EXPECT_TRUE(half_circle().validate().has_value());
  EXPECT_TRUE((Panorama{1, 1, 2.0 * kPi, 1e-9, 0.0}).validate().has_value());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Panorama& wrong :
       {Panorama{0, 640, kPi, 0.4, -0.6}, Panorama{16385, 640, kPi, 0.4, -0.6}, Panorama{2048, 0, kPi, 0.4, -0.6},
        Panorama{2048, -1, kPi, 0.4, -0.6}, Panorama{2048, 640, 0.0, 0.4, -0.6}, Panorama{2048, 640, 6.4, 0.4, -0.6},
        Panorama{2048, 640, nan, 0.4, -0.6}, Panorama{2048, 640, kPi, -0.6, -0.6}, Panorama{2048, 640, kPi, nan, -0.6},
        Panorama{2048, 640, kPi, 0.4, nan}, Panorama{2048, 640, kPi, inf, -0.6}, Panorama{2048, 640, kPi, 0.4, -inf}}) {
    const Status status = wrong.validate();
    ASSERT_FALSE(status.has_value());
    EXPECT_EQ(status.error().code(), ErrorCode::kInvalidArgument);
  }
}

TEST(Panorama, a_guard_band_keeps_the_pixel_size_and_the_middle) {
  for (const double guard : {0.0, 0.01, 0.1, 0.5}) {
    const Panorama wider = half_circle().with_guard_band(guard);
    EXPECT_NEAR(wider.radians_per_px(), half_circle().radians_per_px(), 1e-15);
    EXPECT_EQ(wider.width_px % 16, 0);
    EXPECT_GE(wider.azimuth_span_rad + kTiny, kPi + 2.0 * guard);
    EXPECT_LT(wider.azimuth_span_rad, kPi + 2.0 * guard + 18.0 * half_circle().radians_per_px());
    const PanoramaPixel ahead = wider.pixel_of({0.0, 0.0, -1.0});
    EXPECT_NEAR(ahead.u, 0.5 * wider.width_px, 1e-6);
    EXPECT_TRUE(wider.validate().has_value());
  }
}

TEST(Panorama, a_guard_band_never_exceeds_the_full_circle) {
  const Panorama wider = half_circle().with_guard_band(10.0);
  EXPECT_LE(wider.azimuth_span_rad, 2.0 * kPi + kTiny);
  EXPECT_EQ(wider.width_px, 4096);
  EXPECT_EQ(half_circle().with_guard_band(-1.0), half_circle());
}

TEST(Panorama, wrapped_angles_are_within_one_turn_and_differ_by_full_turns) {
  for (const double angle : {0.0, 1.0, -1.0, kPi, -kPi, 3.0 * kPi, 100.0, -1e6}) {
    const double wrapped = wrapped_angle(angle);
    EXPECT_GT(wrapped, -kPi);
    EXPECT_LE(wrapped, kPi);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-9);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-9);
  }
  EXPECT_EQ(wrapped_angle(-kPi), kPi);
}

}  // namespace
}  // namespace cyclorama
