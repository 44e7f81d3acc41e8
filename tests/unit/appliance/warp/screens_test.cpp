// SPDX-License-Identifier: Apache-2.0
// Warps and blends on screens of every shape.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/warp_mesh.h"
#include "common/geometry/guard_band.h"
#include "common/image/colour.h"
#include "drivers/simulated/room/room_picture.h"
#include "tests/data_sets/demo_room.h"
#include "tests/support/mesh_area.h"
#include "tests/support/warped_picture.h"

namespace cyclorama::warp {
namespace {

class ScreenWarp : public ::testing::TestWithParam<const char*> {
 protected:
  static Installation room() {
    const std::string name = std::string(GetParam()) + ".toml";
    auto read = read_installation(demo_installation_path().parent_path() / name);
    CHECK(read.has_value());
    // Half as many pixels each way take a quarter of the time.
    for (InstalledProjector& projector : read->projectors) {
      Pinhole& lens = projector.lens;
      lens = {lens.width_px / 2, lens.height_px / 2, 0.5 * lens.focal_px, 0.5 * lens.centre_u_px,
              0.5 * lens.centre_v_px};
    }
    return *std::move(read);
  }
  /// The vault's mesh has many folds; with large pixels fewer of them matter.
  static int width_px() { return GetParam() == std::string("mesh") ? 256 : 1024; }
};

TEST_P(ScreenWarp, holds_its_tolerance_at_every_pixel) {
  const Installation room = this->room();
  const PictureShape picture = room.picture(width_px());
  const PixelScale scale = pixel_scale(picture);
  for (const ProjectorMap& map : projector_maps(room)) {
    const auto mesh = make_warp_mesh(map, picture);
    ASSERT_TRUE(mesh) << mesh.error().message();
    EXPECT_LE(mesh->worst_error_px, 0.05);
    double worst = 0.0;
    int lit = 0;
    for (int y = 0; y < map.lens().height_px; ++y) {
      for (int x = 0; x < map.lens().width_px; ++x) {
        const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
        const auto point = map.wall_point_of(pixel);
        if (!point) continue;
        ++lit;
        const auto exact = place_of(picture, point->xyz - room.sweet_spot.xyz);
        const auto meshed = mesh->interpolate(pixel);
        ASSERT_TRUE(exact && meshed) << x << " " << y;
        worst = std::max(worst, scale.distance_px(*exact, {meshed->azimuth_rad, meshed->tan_elevation}));
      }
    }
    EXPECT_GT(lit, 10000);
    EXPECT_LE(worst, 0.06);
    std::printf("%s: %d x %d cells, %zu of them cut, %zu vertices, worst %.4f px\n", GetParam(), mesh->cells_x,
                mesh->cells_y, mesh->cuts.size(), mesh->vertices.size(), worst);
  }
}

TEST_P(ScreenWarp, triangles_cover_the_picture_once) {
  const Installation room = this->room();
  const auto mesh = make_warp_mesh(ProjectorMap(room, 0), room.picture(width_px()));
  ASSERT_TRUE(mesh);
  // Meshes on a wall that continues without end leave out nothing.
  EXPECT_NEAR(area_px2(*mesh), static_cast<double>(mesh->width_px) * mesh->height_px, 2.0);
}

TEST_P(ScreenWarp, lights_the_whole_wall_with_weights_that_add_up_to_one) {
  const Installation room = this->room();
  EXPECT_EQ(unlit_fraction(room), 0.0);
  const std::vector<ProjectorMap> maps = projector_maps(room);
  int shared = 0;
  for (const WallPatch& patch : patches(room.wall, 3000)) {
    double sum = 0.0;
    int lighting = 0;
    for (const double weight : blend_weights(maps, patch.middle)) {
      ASSERT_TRUE(weight >= 0.0 && weight <= 1.0);
      sum += weight;
      lighting += weight > 0.0 ? 1 : 0;
    }
    ASSERT_NEAR(sum, 1.0, 1e-12);
    shared += lighting > 1 ? 1 : 0;
  }
  EXPECT_GT(shared, 200);
}

/// Returns linear light that is smooth, and different in every direction.
std::array<double, 3> light_from(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  return {0.5 + 0.3 * std::sin(4.0 * d.x()), 0.5 + 0.3 * std::cos(5.0 * d.y()), 0.5 + 0.3 * std::sin(3.0 * d.z())};
}

TEST_P(ScreenWarp, shows_the_eye_the_right_light_at_every_heading) {
  const Installation room = this->room();
  const PictureShape wanted = room.picture(width_px());
  const std::vector<ProjectorMap> maps = projector_maps(room);
  const std::vector<MaskImage> masks = make_blend_masks(maps);
  for (const double turn : {0.0, 0.1}) {
    const PictureShape shape = with_guard_band(wanted, turn);
    RgbImage picture(cyclorama::width_px(shape), height_px(shape));
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const auto light = light_from(direction_at(shape, {x + 0.5, y + 0.5}).value_or(Eigen::Vector3d::UnitX()));
        for (std::size_t c = 0; c < 3; ++c) picture.at(x, y)[c] = linear_to_srgb8(static_cast<float>(light[c]));
      }
    }
    const WarpedPicture warped(picture, shape, turn);
    std::vector<RgbImage> heads;
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto warp = make_warp(maps[i], wanted);
      ASSERT_TRUE(warp);
      RgbImage& head = heads.emplace_back(warp::width_px(*warp), height_px(*warp));
      for (int y = 0; y < head.height(); ++y) {
        for (int x = 0; x < head.width(); ++x) {
          const auto codes = warped.at(*warp, masks[i], x, y);
          for (std::size_t c = 0; c < 3; ++c) head.at(x, y)[c] = static_cast<std::uint8_t>(codes[c] + 0.5);
        }
      }
    }
    const simulated::RoomPicture photographer(room, simulated::RoomEye::behind_visitor(room, 16, 9));
    const Eigen::AngleAxisd turned_right(-turn, Eigen::Vector3d::UnitY());
    double worst = 0.0;
    double mean = 0.0;
    int count = 0;
    for (const WallPatch& patch : patches(room.wall, 5000)) {
      const auto seen = photographer.radiance_at(patch.middle, heads);
      const auto expected = light_from(turned_right * (patch.middle.xyz - room.sweet_spot.xyz));
      for (std::size_t c = 0; c < 3; ++c) {
        const double off = std::abs(static_cast<double>(seen[c]) / 0.9 - expected[c]);
        worst = std::max(worst, off);
        mean += off;
        ++count;
      }
    }
    std::printf("%s, turned by %.1f: light off by %.4f at most, %.4f on average\n", GetParam(), turn, worst,
                mean / count);
    EXPECT_LT(mean / count, 0.003);  // A code value is 0.0067 there.
    EXPECT_LT(worst, 0.04);          // With half the pixels, a steep ramp at the dome's rim has an error of .033.
  }
}

INSTANTIATE_TEST_SUITE_P(Demo, ScreenWarp, ::testing::Values("plane", "corner", "dome", "mesh"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(ScreenBlend, lights_the_shadow_of_a_pillar_by_the_other_projector_alone) {
  Installation room;
  room.wall = PlanesWall{
      {WallRectangle::above({-3, -3}, {3, -3}, 0.0, 3.0), WallRectangle::above({-0.5, -1.5}, {0.5, -1.5}, 0.0, 3.0)}};
  room.sweet_spot = {Eigen::Vector3d(0, 1.6, 1)};
  const Eigen::Quaterniond ahead(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  for (const double x : {-2.0, 2.0}) {
    room.projectors.push_back(
        {x < 0 ? "left" : "right", Pinhole::from_field_of_view(320, 240, 2.0), {ahead, Eigen::Vector3d(x, 1.5, 0)}});
  }
  const std::vector<ProjectorMap> maps = projector_maps(room);
  // From the left projector, the pillar hides the area to the right behind it.
  const std::vector<double> behind = blend_weights(maps, {Eigen::Vector3d(1.5, 1.5, -3)});
  EXPECT_EQ(behind[0], 0.0);
  EXPECT_EQ(behind[1], 1.0);
  const std::vector<double> between = blend_weights(maps, {Eigen::Vector3d(0.0, 1.5, -3)});
  EXPECT_NEAR(between[0], 0.5, 1e-12);
  EXPECT_NEAR(between[1], 0.5, 1e-12);
}

}  // namespace
}  // namespace cyclorama::warp
