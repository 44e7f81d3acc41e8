// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/pixel_map.h"

#include <gtest/gtest.h>

#include "appliance/warp/blend_mask.h"
#include "tests/data_sets/demo_room.h"

namespace cyclorama::warp {
namespace {

TEST(PixelMap, is_the_exact_map_at_every_pixel) {
  const ProjectorMap map(demo_room(), 0);
  const Warp warp = make_pixel_map(map, Panorama{});
  ASSERT_EQ(width_px(warp), 640);
  ASSERT_EQ(height_px(warp), 480);
  for (int y = 0; y < 480; y += 7) {
    for (int x = 0; x < 640; x += 7) {
      const auto exact = map.direction_of({x + 0.5, y + 0.5});
      const auto mapped = direction_at(warp, x, y);
      ASSERT_EQ(exact.has_value(), mapped.has_value());
      if (!exact) continue;
      EXPECT_NEAR(mapped->azimuth_rad, exact->azimuth_rad, 1e-6);
      EXPECT_NEAR(mapped->tan_elevation, exact->tan_elevation, 1e-6);
    }
  }
}

TEST(Warp, consists_of_patches_or_a_mesh_or_a_map_as_the_wall_requires) {
  const Installation room = demo_room();
  const ProjectorMap map(room, 1);
  const auto easy = make_warp(map, room.panorama(256), 0.05);
  ASSERT_TRUE(easy);
  ASSERT_TRUE(std::holds_alternative<WarpPatches>(*easy));
  EXPECT_LE(std::get<WarpPatches>(*easy).worst_error_px, 0.05);
  const auto corner = read_installation(demo_installation_path().parent_path() / "corner.toml");
  ASSERT_TRUE(corner) << corner.error().message();
  const auto creased = make_warp(ProjectorMap(*corner, 1), corner->picture(256), 0.05);
  ASSERT_TRUE(creased);
  EXPECT_TRUE(std::holds_alternative<WarpMesh>(*creased));
  const auto hard = make_warp(map, room.panorama(8192), 0.0001);
  ASSERT_TRUE(hard);
  EXPECT_TRUE(std::holds_alternative<PixelMap>(*hard));
}

TEST(Warp, keeps_its_tolerance_on_every_shape_and_is_a_map_for_many_folds) {
  for (const char* const name : {"plane.toml", "dome.toml", "mesh.toml"}) {
    const auto room = read_installation(demo_installation_path().parent_path() / name);
    ASSERT_TRUE(room) << room.error().message();
    const ProjectorMap map(*room, 1);
    const PictureShape picture = room->picture(256);
    const auto warp = make_warp(map, picture, 0.5);
    ASSERT_TRUE(warp) << warp.error().message();
    EXPECT_EQ(std::holds_alternative<PixelMap>(*warp), std::string(name) == "mesh.toml") << name;
    const auto exact = map.place_of({200.5, 300.5}, picture);
    const auto warped = direction_at(*warp, 200, 300);
    ASSERT_TRUE(exact && warped);
    EXPECT_LE(pixel_scale(picture).distance_px(*exact, {warped->azimuth_rad, warped->tan_elevation}), 0.5);
  }
}

TEST(Warp, refuses_an_invalid_panorama) {
  EXPECT_EQ(make_warp(ProjectorMap(demo_room(), 0), Panorama{}).error().code(), ErrorCode::kInvalidArgument);
}

TEST(Warp, has_no_position_where_its_map_is_nan) {
  PixelMap map(2, 1, 0.5f);
  map.at(1, 0)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(direction_at(map, 0, 0));
  EXPECT_FALSE(direction_at(map, 1, 0));
}

}  // namespace
}  // namespace cyclorama::warp
