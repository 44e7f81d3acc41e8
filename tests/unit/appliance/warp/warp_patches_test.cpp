// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/warp_patches.h"

#include <gtest/gtest.h>

#include "appliance/warp/warp_mesh.h"
#include "tests/data_sets/demo_room.h"

namespace cyclorama::warp {
namespace {

/// Returns the maximum error where the projector meets the wall, in the picture's pixels.
double worst_error(const ProjectorMap& map, const WarpPatches& warp, const PictureShape& picture) {
  const PixelScale scale = pixel_scale(picture);
  double worst = 0.0;
  for (int y = 0; y < warp.height_px; y += 3) {
    for (int x = 0; x < warp.width_px; x += 3) {
      const Eigen::Vector2d centre(x + 0.5, y + 0.5);
      if (!map.wall_point_of(centre)) continue;
      const auto exact = map.place_of(centre, picture);
      if (!exact) continue;
      const PanoramaDirection fit = warp.at(centre);
      worst = std::max(worst, scale.distance_px(*exact, {fit.azimuth_rad, fit.tan_elevation}));
    }
  }
  return worst;
}

TEST(WarpPatches, keep_their_tolerance_on_every_smooth_wall) {
  for (const char* const name : {"plane.toml", "dome.toml", "installation.toml"}) {
    const auto room = std::string(name) == "installation.toml"
                          ? Result<Installation>(demo_room())
                          : read_installation(demo_installation_path().parent_path() / name);
    ASSERT_TRUE(room) << room.error().message();
    const bool is_dome = std::string(name) == "dome.toml";  // Its rim has the largest curvature.
    for (const double tolerance : {1.0, is_dome ? 0.1 : 0.05}) {
      const PictureShape picture = room->picture(512);
      const ProjectorMap map(*room, 0);
      const auto warp = make_warp_patches(map, picture, tolerance);
      ASSERT_TRUE(warp) << name << ": " << warp.error().message();
      EXPECT_LE(warp->worst_error_px, tolerance);
      // The error is checked at 81 positions of each patch; between them it may be a little larger.
      EXPECT_LE(worst_error(map, *warp, picture), 1.05 * tolerance) << name;
      EXPECT_EQ(warp->patches.size(), static_cast<std::size_t>(warp->across() * warp->down()));
    }
  }
}

TEST(WarpPatches, are_far_fewer_than_the_cells_of_a_mesh) {
  const Installation room = demo_room();
  const ProjectorMap map(room, 0);
  const auto patches = make_warp_patches(map, room.panorama(2048), 0.05);
  const auto mesh = make_warp_mesh(map, room.panorama(2048), 0.05);
  ASSERT_TRUE(patches && mesh);
  EXPECT_LT(10 * patches->patches.size(), static_cast<std::size_t>(mesh->cells_x * mesh->cells_y));
}

TEST(WarpPatches, meet_at_their_edges_within_the_tolerance) {
  const Installation room = demo_room();
  const PictureShape picture = room.picture(1024);
  const auto warp = make_warp_patches(ProjectorMap(room, 0), picture, 0.05);
  ASSERT_TRUE(warp);
  const PixelScale scale = pixel_scale(picture);
  for (int column = 1; column < warp->across(); ++column) {
    const double x = column * warp->patch_width_px;
    for (int y = 0; y < warp->height_px; y += 5) {
      const PanoramaDirection left = warp->at({x - 1e-6, y + 0.5});
      const PanoramaDirection right = warp->at({x, y + 0.5});
      EXPECT_LE(scale.distance_px({left.azimuth_rad, left.tan_elevation}, {right.azimuth_rad, right.tan_elevation}),
                0.1);
    }
  }
}

TEST(WarpPatches, refuse_walls_that_they_cannot_represent) {
  const Installation room = demo_room();
  const ProjectorMap map(room, 0);
  EXPECT_EQ(make_warp_patches(map, room.panorama(8192), 1e-5).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(make_warp_patches(map, Panorama{}, 0.05).error().code(), ErrorCode::kInvalidArgument);
  const auto corner = read_installation(demo_installation_path().parent_path() / "corner.toml");
  ASSERT_TRUE(corner) << corner.error().message();
  EXPECT_EQ(make_warp_patches(ProjectorMap(*corner, 1), corner->picture(512), 0.05).error().code(),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama::warp
