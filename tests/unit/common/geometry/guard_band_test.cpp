// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/guard_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "common/geometry/picture_place.h"

namespace cyclorama {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kGuard = 8.0 * kDegree;

std::vector<PictureShape> shapes() {
  return {Panorama{1000, 300, 2.0, 0.4, -0.3},
          Perspective{1200, 600, -1.2, 1.2, 0.7, -0.5, 0.0},
          Perspective{1200, 600, -0.4, 1.3, 0.7, -0.5, 0.4},
          Perspective{640, 480, -1.0, 1.0, 0.75, -0.75, 0.5 * kPi},
          Fisheye{1024, 1024, kPi, 0.5 * kPi},
          Fisheye{1024, 1024, 1.1 * kPi, 0.2},
          Fisheye{800, 700, 2.0, 0.0}};
}

/// Positions all over the picture, including its edges, that have a direction.
std::vector<PicturePlace> places(const PictureShape& shape) {
  std::vector<PicturePlace> found;
  for (int j = 0; j <= 40; ++j) {
    for (int i = 0; i <= 40; ++i) {
      const PanoramaPixel p{width_px(shape) * i / 40.0, height_px(shape) * j / 40.0};
      if (direction_at(shape, p)) found.push_back(pixel_scale(shape).place_at(p));
    }
  }
  if (const auto* fisheye = std::get_if<Fisheye>(&shape)) {
    for (int i = 0; i < 256; ++i) {
      const double radius = 0.49999 * fisheye->field_rad;
      found.push_back({radius * std::cos(kPi * i / 128), radius * std::sin(kPi * i / 128)});
    }
  }
  return found;
}

bool contains(const PictureShape& shape, const PicturePlace& place, double slack_px) {
  const PanoramaPixel p = pixel_scale(shape).pixel_at(place);
  if (const auto* fisheye = std::get_if<Fisheye>(&shape)) {
    return std::hypot(place.across, place.up) <= 0.5 * fisheye->field_rad + slack_px * fisheye->radians_per_px();
  }
  return p.u >= -slack_px && p.v >= -slack_px && p.u <= width_px(shape) + slack_px &&
         p.v <= height_px(shape) + slack_px;
}

TEST(GuardBand, contains_what_is_shown_after_every_turn_within_it) {
  for (const PictureShape& shown : shapes()) {
    const PictureShape wide = with_guard_band(shown, kGuard);
    ASSERT_TRUE(validate(wide)) << validate(wide).error().message();
    for (const double turn : {-kGuard, -0.3 * kGuard, 0.0, 0.7 * kGuard, kGuard}) {
      for (const PicturePlace& place : places(shown)) {
        const auto at = turned(shown, place, turn);
        ASSERT_TRUE(at);
        ASSERT_TRUE(contains(wide, *at, 0.01)) << shown.index() << " " << turn << " " << at->across << " " << at->up;
      }
    }
    EXPECT_GE(turn_reach(wide, shown), kGuard - 1e-6) << shown.index();
    EXPECT_NEAR(pixel_scale(wide).u_per_across, pixel_scale(shown).u_per_across,
                0.02 * pixel_scale(shown).u_per_across);
  }
}

TEST(GuardBand, ends_at_the_maximum_turn) {
  for (const PictureShape& shown : shapes()) {
    const PictureShape wide = with_guard_band(shown, kGuard);
    const double reach = turn_reach(wide, shown);
    if (std::isinf(reach)) continue;
    EXPECT_LT(reach, 1.5 * kGuard) << shown.index();
    bool leaves = false;
    for (const double turn : {-1.05 * reach, 1.05 * reach}) {
      for (const PicturePlace& place : places(shown))
        leaves = leaves || !contains(wide, *turned(shown, place, turn), 0.0);
    }
    EXPECT_TRUE(leaves) << shown.index();
  }
}

TEST(GuardBand, is_not_needed_by_a_dome_master_which_turns_without_limit) {
  const PictureShape dome = Fisheye{1024, 1024, kPi, 0.5 * kPi};
  EXPECT_EQ(with_guard_band(dome, kGuard), dome);
  EXPECT_TRUE(std::isinf(turn_reach(dome, dome)));
}

TEST(GuardBand, of_a_panorama_agrees_with_the_panoramas_own) {
  const Panorama panorama{1000, 300, 2.0, 0.4, -0.3};
  EXPECT_EQ(with_guard_band(panorama, kGuard), PictureShape(panorama.with_guard_band(kGuard)));
  EXPECT_NEAR(turn_reach(Panorama{1000, 300, 2.2, 0.4, -0.3}, panorama), 0.1, 1e-12);
  EXPECT_TRUE(std::isinf(turn_reach(Panorama{1000, 300, 2.0 * kPi, 0.4, -0.3}, panorama)));
}

TEST(GuardBand, stops_at_eighty_degrees_in_a_flat_picture) {
  const double tan_75 = std::tan(75.0 * kDegree);
  const Perspective wide{1000, 200, -tan_75, tan_75, 0.2, -0.2, 0.0};
  const auto grown = std::get<Perspective>(with_guard_band(wide, kGuard));
  EXPECT_NEAR(grown.tan_right, std::tan(80.0 * kDegree), 0.2);
  const double reach = turn_reach(grown, wide);
  EXPECT_GT(reach, 4.0 * kDegree);
  EXPECT_LT(reach, 6.0 * kDegree);
  const double tan_89 = std::tan(89.5 * kDegree);
  const PictureShape wider = Perspective{1000, 200, -tan_89, tan_89, 0.2, -0.2, 0.0};
  EXPECT_EQ(with_guard_band(wider, kGuard), wider);
  EXPECT_EQ(turn_reach(wider, wider), 0.0);
}

TEST(GuardBand, contains_what_an_eye_beside_the_pictures_own_sees) {
  constexpr double kMoved = 0.13;
  constexpr double kNearest = 1.6;
  const double angle = parallax(kMoved, kNearest);
  std::mt19937 random(5);
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> one(0.0, 1.0);
  for (const PictureShape& shown : shapes()) {
    const PictureShape wide = with_guard_band(shown, kGuard, angle);
    ASSERT_TRUE(validate(wide)) << validate(wide).error().message();
    EXPECT_GE(turn_reach(wide, shown), kGuard - 1e-6) << shown.index();
    EXPECT_GT(height_px(wide), height_px(shown));
    EXPECT_NEAR(pixel_scale(wide).v_per_up, pixel_scale(shown).v_per_up, 0.02 * -pixel_scale(shown).v_per_up);
    for (const double turn : {-kGuard, 0.0, kGuard}) {
      for (const PicturePlace& place : places(shown)) {
        const auto at = turned(shown, place, turn);
        ASSERT_TRUE(at);
        // The surface that is seen here from an eye elsewhere, as the picture's own eye sees it.
        const Eigen::Vector3d moved =
            kMoved * std::cbrt(one(random)) * Eigen::Vector3d(any(random), any(random), any(random)).normalized();
        const double distance = kNearest * (one(random) < 0.5 ? 1.0 : 1.0 + 5.0 * one(random));
        const Eigen::Vector3d surface = moved + (distance + moved.norm()) * direction_of(shown, *at).normalized();
        const auto seen = place_of(shown, surface);
        ASSERT_TRUE(seen);
        ASSERT_TRUE(contains(wide, *seen, 0.01))
            << shown.index() << " " << turn << " " << seen->across << " " << seen->up;
      }
    }
  }
}

TEST(GuardBand, for_walking_is_no_larger_than_its_angle) {
  const double angle = 4.0 * kDegree;
  const auto round = std::get<Panorama>(with_guard_band(Panorama{1000, 300, 2.0, 0.4, -0.3}, kGuard, angle));
  EXPECT_NEAR(std::atan(round.tan_elevation_top), std::atan(0.4) + angle, 0.003);
  EXPECT_NEAR(std::atan(round.tan_elevation_bottom), std::atan(-0.3) - angle, 0.003);
  EXPECT_LT(round.azimuth_span_rad, 2.0 + 2.0 * (kGuard + 1.1 * angle) + 0.04);
  const auto flat =
      std::get<Perspective>(with_guard_band(Perspective{1200, 600, -0.6, 0.6, 0.3, -0.3, 0.0}, 0.0, angle));
  EXPECT_LT(std::atan(flat.tan_right), std::atan(0.6) + 1.1 * angle + 0.02);
  EXPECT_LT(std::atan(flat.tan_top), std::atan(0.3) + 1.3 * angle);
  const auto dome = std::get<Fisheye>(with_guard_band(Fisheye{1024, 1024, kPi, 0.5 * kPi}, kGuard, angle));
  EXPECT_NEAR(dome.field_rad, kPi + 2.0 * angle, 1e-9);
}

TEST(GuardBand, for_walking_ends_where_no_picture_can_be_larger) {
  EXPECT_EQ(parallax(0.0, 1.6), 0.0);
  EXPECT_EQ(parallax(2.0, 1.6), 0.5 * kPi);
  for (const double angle : {0.3, 1.0, 0.5 * kPi, 9.0}) {
    for (const PictureShape& shown : shapes()) {
      const PictureShape wide = with_guard_band(shown, kGuard, angle);
      ASSERT_TRUE(validate(wide)) << validate(wide).error().message();
      for (const PicturePlace& place : places(shown)) ASSERT_TRUE(contains(wide, place, 0.01));
    }
  }
  const PictureShape tallest = Panorama{16, 16384, 0.1, 0.4, -0.3};
  EXPECT_EQ(height_px(with_guard_band(tallest, 0.0, 0.2)), 16384);
  const double tan_85 = std::tan(85.0 * kDegree);
  const auto high = std::get<Panorama>(with_guard_band(Panorama{1000, 300, 2.0, tan_85, -0.3}, 0.0, 0.1));
  EXPECT_EQ(high.tan_elevation_top, tan_85);
}

TEST(GuardBand, refuses_to_replace_a_picture_of_another_kind) {
  EXPECT_EQ(turn_reach(shapes()[0], shapes()[1]), 0.0);
  EXPECT_EQ(turn_reach(shapes()[1], shapes()[2]), 0.0);  // The tilts differ.
  EXPECT_FALSE(covering(shapes()[0], shapes()[1]));
  EXPECT_FALSE(covering(shapes()[4], shapes()[5]));
}

TEST(Covering, contains_both_with_the_finer_pixels) {
  for (const PictureShape& one : shapes()) EXPECT_EQ(covering(one, one), one);
  const PictureShape left = Perspective{500, 400, -1.0, 0.2, 0.5, -0.5, 0.1};
  const PictureShape right = Perspective{1000, 400, 0.0, 1.0, 0.3, -0.6, 0.1};
  const auto both = covering(left, right);
  ASSERT_TRUE(both);
  EXPECT_EQ(both, covering(right, left));
  for (const PictureShape& one : {left, right}) {
    for (const PicturePlace& place : places(one)) EXPECT_TRUE(contains(*both, place, 1e-6));
    EXPECT_GE(pixel_scale(*both).u_per_across, pixel_scale(one).u_per_across - 1e-6);
  }
  const Panorama wide{800, 200, 4.0, 0.3, -0.3};
  const Panorama tall{600, 600, 1.5, 0.9, -0.5};
  const auto panoramas = covering(wide, tall);
  ASSERT_TRUE(panoramas);
  EXPECT_EQ(panoramas, covering(tall, wide));
  const auto& round = std::get<Panorama>(*panoramas);
  EXPECT_EQ(round.azimuth_span_rad, 4.0);
  EXPECT_EQ(round.tan_elevation_top, 0.9);
  EXPECT_EQ(round.tan_elevation_bottom, -0.5);
  EXPECT_LE(round.radians_per_px(), 1.5 / 600 + 1e-12);
  const auto largest = covering(wide, Panorama{16384, 16384, 0.1, 0.1, -0.1});
  EXPECT_TRUE(largest && validate(*largest)) << "as far as the largest picture allows";
  const auto domes = covering(Fisheye{512, 512, kPi, 0.3}, Fisheye{512, 512, 1.5, 0.3});
  ASSERT_TRUE(domes);
  EXPECT_NEAR(std::get<Fisheye>(*domes).field_rad, kPi, 1e-12);
  EXPECT_NEAR(width_px(*domes), 512 * kPi / 1.5, 1.0);
}

TEST(GuardBand, separates_two_eyes_pictures_by_a_cut_and_keeps_the_field) {
  for (const PictureShape& shape :
       {PictureShape(Panorama{700, 301, 2.0, 0.4, -0.5}),
        PictureShape(Perspective{700, 313, -0.9, 1.1, 0.4, -0.4, 0.2}), PictureShape(Fisheye{500, 480, 2.9, 0.3})}) {
    for (const double guard : {0.0, 0.1, 0.3}) {
      Projection picture{shape, {}};
      EXPECT_EQ(with_guard_band(picture, guard), (Projection{with_guard_band(shape, guard), {}}));
      picture.viewing = {Eyes::kOverUnder, 0.063, 3.0};
      const Projection both = with_guard_band(picture, guard);
      const PictureShape one = with_guard_band(shape, guard);
      EXPECT_EQ(height_px(both.shape) % 16, 0);
      EXPECT_GE(height_px(both.shape), height_px(one));
      EXPECT_LT(height_px(both.shape), height_px(one) + 16);
      EXPECT_EQ(with_pixels(both.shape, width_px(one), height_px(one)), one);
      EXPECT_EQ(both.viewing, picture.viewing);
      EXPECT_TRUE(both.validate());
    }
  }
  const Projection largest{cut_for_two_eyes(Panorama{100, 16384, 2.0, 0.4, -0.5}), {Eyes::kOverUnder, 0.063, 3.0}};
  EXPECT_TRUE(largest.validate());
}

}  // namespace
}  // namespace cyclorama
