// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/warp_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "appliance/warp/blend_mask.h"
#include "tests/data_sets/demo_room.h"
#include "tests/support/mesh_area.h"

namespace cyclorama::warp {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Returns a room that differs from the demo's in every number.
Installation random_room(std::mt19937* random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(*random); };
  Installation room = demo_room();
  const CylinderWall wall{between(2.0, 6.0), between(1.0, 6.28), between(-1.0, 0.5),
                          between(2.0, 4.0), between(-1.0, 1.0), between(-1.0, 1.0)};
  room.wall = wall;
  room.sweet_spot = {
      Eigen::Vector3d(between(-0.5, 0.5) + wall.centre_x_m, between(1.0, 2.0), between(-0.5, 0.5) + wall.centre_z_m)};
  room.projectors.resize(1);
  room.projectors[0].lens = Pinhole::from_field_of_view(320, 200, between(0.4, 1.4));
  room.projectors[0].lens.centre_v_px += between(-80.0, 80.0);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(between(-3.1, 3.1), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(std::numbers::pi + between(-0.2, 0.2), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(between(-0.2, 0.2), Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d position(wall.centre_x_m + between(-0.8, 0.8), between(0.5, 3.0),
                                 wall.centre_z_m + between(-0.8, 0.8));
  room.projectors[0].T_room_projector = {turned, position};
  return room;
}

TEST(ProjectorMap, has_for_every_lit_wall_point_the_direction_from_the_eye) {
  std::mt19937 random(1);
  int lit = 0;
  for (int n = 0; n < 60; ++n) {
    const Installation room = random_room(&random);
    const CylinderWall& wall = cylinder_of(room);
    const ProjectorMap map(room, 0);
    for (int i = 0; i < 400; ++i) {
      const double arc = wall.arc_rad * std::uniform_real_distribution(-0.5, 0.5)(random);
      const double height = std::uniform_real_distribution(wall.bottom_m, wall.top_m)(random);
      const Point<frame::Room> point = wall.point_at(arc, height);
      const auto pixel = map.pixel_lighting(point);
      if (!pixel) continue;
      ++lit;
      const auto direction = map.direction_of(*pixel);
      ASSERT_TRUE(direction);
      const Eigen::Vector3d seen = point.xyz - room.sweet_spot.xyz;
      EXPECT_NEAR(wrapped_angle(direction->azimuth_rad - std::atan2(seen.x(), -seen.z())), 0.0, 1e-9);
      EXPECT_NEAR(direction->tan_elevation, seen.y() / std::hypot(seen.x(), seen.z()), 1e-9);
      const auto back = map.wall_point_of(*pixel);
      if (back) {
        EXPECT_LT((back->xyz - point.xyz).norm(), 1e-9);
      }
    }
  }
  EXPECT_GT(lit, 1000);
}

TEST(ProjectorMap, is_continuous_where_the_azimuth_passes_half_a_turn) {
  Installation room = demo_room();
  std::get<CylinderWall>(room.wall).arc_rad = 2.0 * std::numbers::pi;
  room.projectors.resize(1);
  room.projectors[0].T_room_projector = {
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())),
      Eigen::Vector3d(0.0, 1.6, 0.0)};  // It looks along +z: behind the visitor.
  const ProjectorMap map(room, 0);
  double previous = map.direction_of({0.5, 200.5})->azimuth_rad;
  for (int x = 1; x < 640; ++x) {
    const double azimuth = map.direction_of({x + 0.5, 200.5})->azimuth_rad;
    ASSERT_LT(std::abs(azimuth - previous), 0.2 * kDegree) << x;
    previous = azimuth;
  }
}

TEST(WarpMesh, holds_its_tolerance_at_every_pixel_of_the_demo) {
  const Installation room = demo_room();
  for (const int width_px : {1024, 4096}) {
    const Panorama picture = room.panorama(width_px);
    for (const ProjectorMap& map : projector_maps(room)) {
      const auto mesh = make_warp_mesh(map, picture);
      ASSERT_TRUE(mesh) << mesh.error().message();
      double worst = 0.0;
      for (int y = 0; y < map.lens().height_px; ++y) {
        for (int x = 0; x < map.lens().width_px; ++x) {
          const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
          if (!map.wall_point_of(pixel)) continue;
          const auto exact = map.direction_of(pixel);
          const auto meshed = mesh->interpolate(pixel);
          ASSERT_TRUE(meshed);
          const double du = (exact->azimuth_rad - meshed->azimuth_rad) / picture.radians_per_px();
          const double dv = (exact->tan_elevation - meshed->tan_elevation) / picture.radians_per_px();
          worst = std::max(worst, std::hypot(du, dv));
        }
      }
      EXPECT_LE(worst, 0.055) << width_px;  // A tenth more than at the sampled positions.
      RecordProperty("vertices", static_cast<int>(mesh->vertices.size()));
      std::printf("panorama %d px: %d x %d cells, %zu vertices, worst %.4f px\n", width_px, mesh->cells_x,
                  mesh->cells_y, mesh->vertices.size(), worst);
    }
  }
}

TEST(WarpMesh, is_no_finer_than_necessary) {
  const Installation room = demo_room();
  const ProjectorMap map(room, 1);
  const auto fine = make_warp_mesh(map, room.panorama(2048), 0.05);
  const auto coarse = make_warp_mesh(map, room.panorama(2048), 1.0);
  ASSERT_TRUE(fine && coarse);
  EXPECT_LT(coarse->vertices.size(), fine->vertices.size());
  EXPECT_LT(fine->vertices.size(), 20000U);
}

TEST(WarpMesh, maps_its_vertices_exactly_and_covers_the_picture_with_triangles) {
  const Installation room = demo_room();
  const auto mesh = make_warp_mesh(ProjectorMap(room, 0), room.panorama(1024));
  ASSERT_TRUE(mesh);
  for (const WarpVertex& vertex : mesh->vertices) {
    const auto at = mesh->interpolate({vertex.x_px, vertex.y_px});
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->azimuth_rad, vertex.azimuth_rad, 1e-9);
    EXPECT_NEAR(at->tan_elevation, vertex.tan_elevation, 1e-9);
  }
  EXPECT_NEAR(area_px2(*mesh), 640.0 * 480.0, 1.0);
}

TEST(WarpMesh, leaves_out_pixels_without_a_direction) {
  WarpMesh mesh{2, 2, 2, 2, std::vector<WarpVertex>(9), 0.0};
  EXPECT_EQ(mesh.triangles().size(), 3U * 8U);
  mesh.vertices[0].azimuth_rad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(mesh.triangles().size(), 3U * 6U);
  EXPECT_FALSE(mesh.interpolate({0.4, 0.2}));
  EXPECT_TRUE(mesh.interpolate({1.5, 1.2}));
}

TEST(WarpMesh, refuses_an_invalid_panorama) {
  const Installation room = demo_room();
  EXPECT_EQ(make_warp_mesh(ProjectorMap(room, 0), Panorama{}).error().code(), ErrorCode::kInvalidArgument);
}

TEST(WarpMesh, holds_its_tolerance_in_random_rooms_or_reports_that_it_cannot) {
  std::mt19937 random(7);
  int made = 0;
  for (int n = 0; n < 40; ++n) {
    const Installation room = random_room(&random);
    const auto mesh = make_warp_mesh(ProjectorMap(room, 0), room.panorama(1200));
    if (mesh) {
      ++made;
      EXPECT_LE(mesh->worst_error_px, 0.05);
    } else {
      EXPECT_EQ(mesh.error().code(), ErrorCode::kInvalidArgument);
    }
  }
  EXPECT_GT(made, 30);
}

}  // namespace
}  // namespace cyclorama::warp
