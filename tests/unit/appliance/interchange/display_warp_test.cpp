// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/display_warp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "appliance/interchange/mpcdi.h"
#include "tests/data_sets/demo_room.h"

namespace cyclorama::interchange {
namespace {

using ::testing::HasSubstr;

constexpr double kTolerancePx = 0.1;
constexpr double kRimRad = 3e-3;  ///< Margin at the wall's end: a fifth of a pixel of these small projectors.

/// The room's middle projector with a tenth of its pixels, through an MPCDI file and back.
class DisplayWarpTest : public ::testing::Test {
 protected:
  DisplayWarpTest()
      : room_(demo_room_with_pixels_over(10)),
        map_(room_, 1),
        masks_(warp::make_blend_masks(warp::projector_maps(room_))) {}

  static WarpRegion through_file(WarpRegion region, WarpProfile profile) {
    WarpSet set;
    set.profile = profile;
    set.buffers.push_back({"wall", 0, 0, {std::move(region)}});
    const auto bytes = encode_mpcdi(set);
    CHECK(bytes.has_value());
    const auto back = decode_mpcdi(*bytes);
    CHECK(back.has_value());
    return back->set.buffers[0].regions[0];
  }

  /// Returns the maximum angle between the mesh and the projector's true directions, on the wall.
  double worst_angle(const warp::WarpMesh& mesh) const {
    double worst = 0.0;
    int drawn = 0;
    for (int y = 0; y < mesh.height_px; ++y) {
      for (int x = 0; x < mesh.width_px; ++x) {
        const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
        if (!map_.wall_point_of(pixel)) continue;
        const auto truth = map_.direction_of(pixel);
        const auto meshed = mesh.interpolate(pixel);
        if (!truth || !meshed) continue;
        ++drawn;
        worst = std::max(
            worst, std::hypot(truth->azimuth_rad - meshed->azimuth_rad, truth->tan_elevation - meshed->tan_elevation));
      }
    }
    CHECK(drawn > 0);
    return worst;
  }

  Installation room_;
  warp::ProjectorMap map_;
  std::vector<warp::MaskImage> masks_;
};

TEST_F(DisplayWarpTest, a_flat_region_draws_what_the_projector_showed) {
  const Panorama picture = room_.panorama(2048);
  const auto mesh = warp::make_warp_mesh(map_, picture, 0.2);
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message();
  const WarpRegion region = through_file(region_of(*mesh, masks_[1], picture, "middle"), WarpProfile::k2d);
  const auto directions = directions_of(region, WarpProfile::k2d, {.picture = picture, .eye_m = {}});
  ASSERT_TRUE(directions.has_value()) << directions.error().message();
  const auto back = mesh_from(*directions, region.width_px, region.height_px, picture, kTolerancePx);
  ASSERT_TRUE(back.has_value()) << back.error().message();
  EXPECT_LT(worst_angle(*back), kRimRad);
  const warp::MaskImage mask = mask_of(region);
  int lit = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!std::isnan(region.map->at(x, y)[0])) {
        EXPECT_NEAR(*mask.at(x, y), *masks_[1].at(x, y), 1e-5);
        ++lit;
      } else {
        EXPECT_EQ(*mask.at(x, y), 0.0f);
      }
    }
  }
  EXPECT_GT(lit, mask.width() * mask.height() / 2);
}

TEST_F(DisplayWarpTest, points_on_the_wall_draw_what_the_projector_showed) {
  const Panorama picture = room_.panorama(2048);
  const WarpRegion region =
      through_file(region_in_space(map_, room_.sweet_spot, masks_[1], "middle"), WarpProfile::kAdvanced3d);
  EXPECT_EQ(region.unit, LengthUnit::kMetre);
  const auto directions = directions_of(region, WarpProfile::kAdvanced3d, {});
  ASSERT_TRUE(directions.has_value()) << directions.error().message();
  const auto back = mesh_from(*directions, region.width_px, region.height_px, picture, kTolerancePx);
  ASSERT_TRUE(back.has_value());
  EXPECT_LT(worst_angle(*back), kRimRad);
}

TEST_F(DisplayWarpTest, points_from_the_floor_need_the_eyes_position) {
  WarpRegion region = region_in_space(map_, room_.sweet_spot, masks_[1], "middle");
  const auto expected = directions_of(region, WarpProfile::kAdvanced3d, {});
  ASSERT_TRUE(expected.has_value());
  const Eigen::Vector3d eye(0.1, 1.6, -0.2);
  for (int y = 0; y < region.height_px; ++y) {
    for (int x = 0; x < region.width_px; ++x) {
      for (int i = 0; i < 3; ++i) {
        float& value = region.map->at(x, y)[i];
        value = static_cast<float>((static_cast<double>(value) + eye[i]) / 0.3048);
      }
    }
  }
  region.unit = LengthUnit::kFoot;
  region.origin = DataOrigin::kFloorCentre;
  EXPECT_THAT(directions_of(region, WarpProfile::kAdvanced3d, {}).error().message(), HasSubstr("sweet spot"));
  const auto moved = directions_of(region, WarpProfile::kAdvanced3d, {.picture = Panorama{}, .eye_m = eye});
  ASSERT_TRUE(moved.has_value());
  for (std::size_t i = 0; i < moved->data().size(); ++i) {
    if (std::isnan(expected->data()[i])) continue;
    EXPECT_NEAR(moved->data()[i], expected->data()[i], 1e-5) << i;
  }
}

TEST_F(DisplayWarpTest, a_whole_room_is_written_with_its_projectors_names_and_blend) {
  const auto bytes = encode_mpcdi(set_of(room_));
  ASSERT_TRUE(bytes.has_value()) << bytes.error().message();
  const auto file = decode_mpcdi(*bytes);
  ASSERT_TRUE(file.has_value()) << file.error().message();
  EXPECT_EQ(file->set.buffers[0].id, room_.name);
  ASSERT_EQ(file->set.buffers[0].regions.size(), room_.projectors.size());
  for (std::size_t i = 0; i < room_.projectors.size(); ++i) {
    const WarpRegion* const region = file->set.region(room_.projectors[i].name);
    ASSERT_NE(region, nullptr);
    EXPECT_NEAR(region->alpha->light_at(32, 24), *masks_[i].at(32, 24), 1e-5) << i;
  }
}

WarpRegion looking(double yaw, double pitch, double roll, float u, float v) {
  WarpRegion region;
  region.id = "r";
  region.width_px = region.height_px = 1;
  region.frustum = WarpFrustum{yaw, pitch, roll, 45.0, -45.0, 45.0, -45.0};
  region.map = WarpMap(1, 1);
  region.map->at(0, 0)[0] = u;
  region.map->at(0, 0)[1] = v;
  return region;
}

void expect_direction(const WarpRegion& region, const Eigen::Vector3d& expected) {
  const auto directions = directions_of(region, WarpProfile::k3d, {});
  ASSERT_TRUE(directions.has_value()) << directions.error().message();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(directions->at(0, 0)[i], expected.normalized()[i], 1e-6) << i;
}

TEST(Directions, a_frustum_is_turned_right_then_up_then_clockwise) {
  expect_direction(looking(0, 0, 0, 0.5f, 0.5f), {0, 0, -1});
  expect_direction(looking(0, 0, 0, 1.0f, 1.0f), {1, 1, -1});  // The picture's upper right corner.
  expect_direction(looking(90, 0, 0, 0.5f, 0.5f), {1, 0, 0});
  expect_direction(looking(0, 90, 0, 0.5f, 0.5f), {0, 1, 0});
  expect_direction(looking(0, 0, 90, 0.5f, 1.0f), {1, 0, -1});  // Its upper edge lies to the right.
  expect_direction(looking(90, 45, 0, 0.5f, 0.5f), {1, 1, 0});
}

TEST(Directions, a_region_is_a_part_of_its_buffers_picture) {
  WarpRegion region = looking(0, 0, 0, 0.5f, 0.5f);
  region.rect = {0.5, 0.5, 0.5, 0.5};  // The upper right quarter.
  const Panorama picture{400, 200, 2.0, 0.5, -0.5};
  const auto directions = directions_of(region, WarpProfile::k2d, {.picture = picture, .eye_m = {}});
  ASSERT_TRUE(directions.has_value()) << directions.error().message();
  const float* const d = directions->at(0, 0);
  EXPECT_NEAR(std::atan2(d[0], -d[2]), 0.5, 1e-6);
  EXPECT_NEAR(d[1] / std::hypot(d[0], d[2]), 0.25, 1e-6);
}

TEST(Directions, refuses_what_is_not_visible_with_a_remedy) {
  WarpRegion region = looking(0, 0, 0, 0.5f, 0.5f);
  EXPECT_THAT(directions_of(region, WarpProfile::kAdvanced3d, {}).error().message(), HasSubstr("geometricUnit"));
  EXPECT_EQ(directions_of(region, WarpProfile::k2d, {}).error().code(), ErrorCode::kInvalidArgument) << "no picture";
  region.unit = LengthUnit::kMetre;
  region.origin = DataOrigin::kIdealEyePoint;
  region.map = WarpMap(1, 1);
  EXPECT_THAT(directions_of(region, WarpProfile::kAdvanced3d, {}).error().message(), HasSubstr("no sample"));
  region.map.reset();
  EXPECT_THAT(directions_of(region, WarpProfile::k3d, {}).error().message(), HasSubstr("geometryWarpFile"));
}

TEST(MeshFrom, azimuths_are_continuous_across_half_a_turn) {
  DirectionMap directions(64, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double azimuth = 3.14159265 + 0.4 * ((x + 0.5) / 64 - 0.5);
      const float level = static_cast<float>(std::cos(0.1));
      directions.at(x, y)[0] = level * static_cast<float>(std::sin(azimuth));
      directions.at(x, y)[1] = static_cast<float>(std::sin(0.1));
      directions.at(x, y)[2] = -level * static_cast<float>(std::cos(azimuth));
    }
  }
  const auto mesh = mesh_from(directions, 64, 8, Panorama{6283, 1000, 2.0 * std::numbers::pi, 0.5, -0.5}, 1.0);
  ASSERT_TRUE(mesh.has_value());
  for (int x = 0; x + 1 < 64; ++x) {
    const double step = mesh->interpolate({x + 1.5, 4.0})->azimuth_rad - mesh->interpolate({x + 0.5, 4.0})->azimuth_rad;
    EXPECT_NEAR(step, 0.4 / 64, 1e-4) << x;
  }
}

TEST(MeshFrom, refuses_a_map_without_a_mapped_sample) {
  const DirectionMap none(8, 8, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(mesh_from(none, 8, 8, Panorama{1024, 512, 2.0, 0.5, -0.5}, 1.0).error().message(),
              HasSubstr("too little"));
}

TEST(BlackLevel, is_light_after_gamma_in_projector_pixels) {
  WarpRegion region = looking(0, 0, 0, 0.5f, 0.5f);
  EXPECT_FALSE(black_level_of(region).has_value());
  region.width_px = 4;
  region.height_px = 2;
  region.beta = MaskMap(1, 1, 1, 8);
  region.beta->samples = {51};
  region.beta->gamma = 2.0;
  const auto level = black_level_of(region);
  ASSERT_TRUE(level.has_value());
  EXPECT_EQ(level->width(), 4);
  EXPECT_NEAR(*level->at(3, 1), 0.04, 1e-6);
}

}  // namespace
}  // namespace cyclorama::interchange
