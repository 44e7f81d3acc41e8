// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reprojection_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "appliance/display/eye_move.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

InverseDepthImage depth_of(const Projection& picture, float distance_m) {
  const PixelRect cells = depth_cells({0, 0, picture.width_px(), picture.height_px()});
  return {cells.width, cells.height, inverse_depth_of(distance_m)};
}

std::shared_ptr<const ReprojectionGrid> grid_of(const Projection& picture, int cells = 1) {
  return std::make_shared<const ReprojectionGrid>(picture, cells * kDepthCellPx);
}

const Projection kPanorama{Panorama{256, 96, 2.5, 0.6, -0.6}, {}};
const Projection kFlat{Perspective{200, 120, -0.8, 0.7, 0.5, -0.6, 0.2}, {}};
const Projection kDome{Fisheye{160, 160, std::numbers::pi, 1.2}, {}};

/// Largest distance in pixels between a moved vertex and the projection of its point, computed in double; for vertices
/// inside the picture.
double worst_place_px(const Projection& picture, float distance_m, const Eigen::Vector3d& eye) {
  const ReprojectionMesh mesh(grid_of(picture), depth_of(picture, distance_m));
  ReprojectedPicture moved;
  mesh.move(eye, &moved);
  const double distance = 1.0 / inverse_metres(inverse_depth_of(distance_m));
  const PixelScale scale = pixel_scale(picture.shape);
  double worst = 0.0;
  for (std::size_t i = 0; i < mesh.grid().across_px.size(); ++i) {
    const ReprojectedVertex& vertex = moved.vertices[i];
    const PanoramaPixel source{mesh.grid().across_px[i], mesh.grid().down_px[i]};
    if (!(source.u > 0.0 && source.u < picture.width_px() && source.v > 0.0 && source.v < picture.height_px()))
      continue;
    const auto direction = direction_at(picture.shape, source);
    if (!direction) continue;
    const auto place = place_of(picture.shape, direction->normalized() * distance - eye);
    if (!place) continue;
    const PanoramaPixel expected = scale.pixel_at(*place);
    worst = std::max(worst, std::hypot(expected.u - vertex.across_px, expected.v - vertex.down_px));
  }
  return worst;
}

TEST(ReprojectionMeshTest, moves_every_vertex_to_where_its_point_is_seen) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> metres(-0.2, 0.2);
  for (const Projection& picture : {kPanorama, kFlat, kDome}) {
    for (int n = 0; n < 20; ++n) {
      const Eigen::Vector3d eye(metres(random), metres(random), metres(random));
      EXPECT_LT(worst_place_px(picture, 1.0f, eye), 0.02);
      EXPECT_LT(worst_place_px(picture, 40.0f, eye), 0.02);
    }
  }
}

TEST(ReprojectionMeshTest, finds_every_point_in_a_picture_from_another_eye_and_heading) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-0.2, 0.2);
  for (const Projection& picture : {kPanorama, kFlat, kDome}) {
    const ReprojectionMesh mesh(grid_of(picture), depth_of(picture, 2.0f));
    const double distance = 1.0 / inverse_metres(inverse_depth_of(2.0f));
    const PixelScale scale = pixel_scale(picture.shape);
    ReprojectedPicture found;
    for (int n = 0; n < 10; ++n) {
      const Eigen::Vector3d eye(any(random), any(random), any(random));
      const double turn = n == 0 ? 0.0 : any(random);
      mesh.find_in(eye, turn, &found);
      // A direction of this picture, in the Eye frame of the one that it was turned away from.
      const Eigen::AngleAxisd R_before_now(-turn, Eigen::Vector3d::UnitY());
      double worst_px = 0.0;
      for (std::size_t i = 0; i < mesh.grid().across_px.size(); ++i) {
        const ReprojectedVertex& vertex = found.vertices[i];
        const PanoramaPixel source{mesh.grid().across_px[i], mesh.grid().down_px[i]};
        EXPECT_EQ(vertex.source_across_px, mesh.grid().across_px[i]);
        if (!(source.u > 0.0 && source.u < picture.width_px() && source.v > 0.0 && source.v < picture.height_px()))
          continue;
        const auto direction = direction_at(picture.shape, source);
        if (!direction) continue;
        const Eigen::Vector3d point = direction->normalized() * distance - eye;
        EXPECT_NEAR(vertex.inverse_m, 1.0 / point.norm(), 1e-3);
        const auto without_turn = place_of(picture.shape, point);
        if (without_turn) {
          const PanoramaPixel shifted = scale.pixel_at(*without_turn);
          EXPECT_NEAR(found.parallax_px[i], std::hypot(shifted.u - source.u, shifted.v - source.v), 0.05);
        }
        const auto place = place_of(picture.shape, R_before_now * point);
        if (!place) continue;
        const PanoramaPixel expected = scale.pixel_at(*place);
        worst_px = std::max(worst_px, std::hypot(expected.u - vertex.across_px, expected.v - vertex.down_px));
      }
      EXPECT_LT(worst_px, 0.05) << picture.shape.index() << ' ' << turn;
    }
  }
}

TEST(ReprojectionMeshTest, leaves_every_vertex_in_place_for_no_move_and_at_infinity) {
  for (const Projection& picture : {kPanorama, kFlat, kDome}) {
    EXPECT_LT(worst_place_px(picture, 0.5f, Eigen::Vector3d::Zero()), 1e-3);
    const ReprojectionMesh mesh(grid_of(picture), depth_of(picture, std::numeric_limits<float>::infinity()));
    ReprojectedPicture moved;
    mesh.move({0.3, -0.2, 0.4}, &moved);
    for (std::size_t i = 0; i < moved.vertices.size(); ++i) {
      EXPECT_NEAR(moved.vertices[i].across_px, mesh.grid().across_px[i], 1e-3);
      EXPECT_NEAR(moved.vertices[i].down_px, mesh.grid().down_px[i], 1e-3);
    }
  }
}

TEST(ReprojectionMeshTest, is_finite_for_every_move_through_any_surface) {
  for (const Projection& picture : {kPanorama, kFlat, kDome}) {
    for (const float distance : {1e-3f, 0.1f, 0.3f, 1e4f}) {
      const ReprojectionMesh mesh(grid_of(picture), depth_of(picture, distance));
      ReprojectedPicture moved;
      for (const double size : {1e-12, 1e-3, 0.6, 10.0, 1e6}) {
        for (const Eigen::Vector3d& way :
             {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 0, 1),
              Eigen::Vector3d(1, 1, -1)}) {
          mesh.move(size * way, &moved);
          for (const ReprojectedVertex& vertex : moved.vertices) {
            ASSERT_TRUE(std::isfinite(vertex.across_px) && std::isfinite(vertex.down_px)) << distance << ' ' << size;
          }
        }
      }
    }
  }
}

/// A wall at 4 m with a bar at 1 m in front of its middle third.
InverseDepthImage bar_before_wall(const Projection& picture) {
  InverseDepthImage depth = depth_of(picture, 4.0f);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = depth.width() / 3; x < 2 * depth.width() / 3; ++x) *depth.at(x, y) = inverse_depth_of(1.0f);
  }
  return depth;
}

TEST(ReprojectionMeshTest, tears_at_an_edge_once_it_stretches) {
  const ReprojectionMesh mesh(grid_of(kPanorama), bar_before_wall(kPanorama));
  EXPECT_GT(mesh.jumps(), 0U);
  ReprojectedPicture moved;
  mesh.move({0.01, 0.0, 0.0}, &moved);
  EXPECT_EQ(moved.torn, 0U);  // Three quarters of a pixel.
  mesh.move({0.2, 0.0, 0.0}, &moved);
  EXPECT_GT(moved.torn, 20U);
}

TEST(ReprojectionMeshTest, fills_a_tear_with_the_colours_and_the_distance_of_the_far_side) {
  const ReprojectionMesh mesh(grid_of(kPanorama), bar_before_wall(kPanorama));
  ReprojectedPicture moved;
  mesh.move({0.2, 0.0, 0.0}, &moved);
  const float near = inverse_metres(inverse_depth_of(1.0f));
  const std::size_t of_grid = mesh.grid().across_px.size();
  ASSERT_EQ(moved.vertices.size(), of_grid + 8 * moved.torn);
  for (std::size_t quad = of_grid; quad < moved.vertices.size(); quad += 8) {
    for (std::size_t i = quad; i < quad + 4; ++i) {
      const ReprojectedVertex& corner = moved.vertices[i];
      EXPECT_LT(corner.inverse_m, 0.5f * near);
      // The bar's cells begin at 84 and end at 168.
      EXPECT_TRUE(corner.source_across_px < 84.0f || corner.source_across_px > 168.0f) << corner.source_across_px;
    }
    for (std::size_t i = quad + 4; i < quad + 8; ++i) {
      const ReprojectedVertex& corner = moved.vertices[i];
      EXPECT_GT(corner.inverse_m, 0.7f * near);  // Distances are those from the moved eye.
      EXPECT_TRUE(corner.source_across_px >= 84.0f && corner.source_across_px <= 168.0f) << corner.source_across_px;
    }
  }
}

TEST(ReprojectionMeshTest, never_tears_a_floor_seen_at_a_slant) {
  const Projection picture{Panorama{512, 192, 2.5, 0.2, -0.8}, {}};
  InverseDepthImage depth = depth_of(picture, 1.0f);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const auto ray = direction_at(picture.shape, {4.0 * x + 2.0, 4.0 * y + 2.0});
      const double down = -ray->normalized().y();
      *depth.at(x, y) = down > 0.0 ? inverse_depth_of(static_cast<float>(1.6 / down)) : std::uint16_t{0};
    }
  }
  const ReprojectionMesh mesh(grid_of(picture), depth);
  ReprojectedPicture moved;
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, 0, -0.3), Eigen::Vector3d(0, 0, 0.3)}) {
    mesh.move(eye, &moved);
    EXPECT_EQ(moved.torn, 0U);
  }
}

TEST(ReprojectionMeshTest, moves_a_quad_across_an_edge_as_a_whole_with_its_near_side) {
  const ReprojectionMesh mesh(grid_of(kPanorama), bar_before_wall(kPanorama));
  ReprojectedPicture found;
  mesh.find_in({0.2, 0.0, 0.0}, 0.0, &found);
  const std::size_t of_grid = mesh.grid().across_px.size();
  ASSERT_EQ(found.vertices.size(), of_grid + 4 * mesh.jumps());
  for (std::size_t quad = of_grid; quad < found.vertices.size(); quad += 4) {
    const ReprojectedVertex& first = found.vertices[quad];
    EXPECT_GT(first.inverse_m, 0.7f * inverse_metres(inverse_depth_of(1.0f)));
    for (std::size_t i = quad + 1; i < quad + 4; ++i) {
      const ReprojectedVertex& corner = found.vertices[i];
      EXPECT_EQ(corner.inverse_m, first.inverse_m);
      EXPECT_NEAR(corner.across_px - first.across_px, corner.source_across_px - first.source_across_px, 1e-3);
    }
  }
}

TEST(ReprojectionMeshTest, lies_on_a_slanted_surface_though_cells_tell_their_nearest_pixel) {
  const Projection picture{Panorama{512, 192, 2.5, -0.1, -0.8}, {}};
  const PixelRect cells = depth_cells({0, 0, 512, 192});
  InverseDepthImage depth(cells.width, cells.height);
  for (int y = 0; y < 192; ++y) {
    for (int x = 0; x < 512; ++x) {
      const double down = -direction_at(picture.shape, {x + 0.5, y + 0.5})->normalized().y();
      std::uint16_t* const cell = depth.at(x / kDepthCellPx, y / kDepthCellPx);
      *cell = std::max(*cell, inverse_depth_of(static_cast<float>(1.6 / down)));
    }
  }
  for (const int mesh_cells : {1, 2}) {
    const ReprojectionMesh mesh(grid_of(picture, mesh_cells), depth);
    ReprojectedPicture moved;
    mesh.move(Eigen::Vector3d::Zero(), &moved);
    double sum_m = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < mesh.grid().across_px.size(); ++i) {
      const double u = mesh.grid().across_px[i];
      const double v = mesh.grid().down_px[i];
      if (!(u > 16.0 && u < 496.0 && v > 16.0 && v < 176.0)) continue;
      const double down = -direction_at(picture.shape, {u, v})->normalized().y();
      sum_m += down / moved.vertices[i].inverse_m;
      ++count;
    }
    EXPECT_NEAR(sum_m / count, 1.6, 0.008) << mesh_cells;
  }
}

TEST(ReprojectionMeshTest, takes_the_nearest_of_the_cells_around_a_vertex) {
  InverseDepthImage depth = depth_of(kPanorama, 8.0f);
  *depth.at(11, 7) = inverse_depth_of(0.5f);
  const ReprojectionMesh mesh(grid_of(kPanorama, 2), depth);
  ReprojectedPicture moved;
  mesh.move({0.1, 0.0, 0.0}, &moved);
  int near = 0;
  for (std::size_t i = 0; i < mesh.grid().across_px.size(); ++i) near += moved.vertices[i].inverse_m > 1.0f ? 1 : 0;
  EXPECT_EQ(near, 1);
}

TEST(ReprojectionMeshTest, uses_the_depth_of_a_smaller_picture_from_the_same_eye) {
  const Projection small{Panorama{128, 48, 2.5, 0.6, -0.6}, {}};
  const ReprojectionMesh own(grid_of(kPanorama), bar_before_wall(kPanorama));
  const ReprojectionMesh borrowed(grid_of(kPanorama), bar_before_wall(small));
  ReprojectedPicture a, b;
  own.move({0.1, 0.05, 0.0}, &a);
  borrowed.move({0.1, 0.05, 0.0}, &b);
  std::size_t differ = 0;
  const std::size_t count = own.grid().across_px.size();
  for (std::size_t i = 0; i < count; ++i) differ += std::abs(a.vertices[i].across_px - b.vertices[i].across_px) > 0.01f;
  EXPECT_LT(differ, count / 20);  // Only along the bar's edges.
}

TEST(ReprojectionMeshTest, continues_a_whole_turn_across_its_seam) {
  const Projection round{Panorama{320, 64, kTurn, 0.5, -0.5}, {}};
  const ReprojectionMesh mesh(grid_of(round), depth_of(round, 2.0f));
  ReprojectedPicture moved;
  mesh.move({0.3, 0.0, 0.1}, &moved);
  const auto columns = static_cast<std::size_t>(mesh.grid().columns);
  for (std::size_t row = 0; row < static_cast<std::size_t>(mesh.grid().rows); ++row) {
    const ReprojectedVertex& first = moved.vertices[row * columns];
    const ReprojectedVertex& last = moved.vertices[(row + 1) * columns - 1];
    EXPECT_NEAR(last.across_px - first.across_px, 320.0f, 0.01f);
    EXPECT_NEAR(last.down_px, first.down_px, 0.01f);
  }
}

TEST(ReprojectionMeshTest, moves_both_eyes_pictures_of_a_stereo_pair) {
  Projection both{Panorama{128, 64, 2.0, 0.5, -0.5}, {}};
  both.viewing.eyes = Eyes::kOverUnder;
  both.viewing.eye_distance_m = 0.063;
  both.viewing.screen_distance_m = 3.0;
  const ReprojectionMesh mesh(grid_of(both), depth_of(both, 2.0f));
  ReprojectedPicture moved;
  mesh.move({0.1, 0.0, 0.0}, &moved);
  const std::size_t of_one = mesh.grid().across_px.size() / 2;
  for (std::size_t i = 0; i < of_one; ++i) {
    // Each eye's points are as far away; the eyes' rays differ by a few degrees.
    EXPECT_NEAR(moved.vertices[of_one + i].across_px, moved.vertices[i].across_px, 0.2);
    EXPECT_NEAR(moved.vertices[of_one + i].down_px - 64.0f, moved.vertices[i].down_px, 0.2);
  }
}

TEST(EyeMoveTest, turns_the_way_into_the_frame_of_the_picture) {
  // At a heading of a quarter turn to the right the eye looks along x of the scene.
  const EyeMove ahead = eye_move({1, 2, 3}, 0.5 * std::numbers::pi, {1.1, 2, 3});
  EXPECT_TRUE(ahead.eye_m.isApprox(Eigen::Vector3d(0, 0, -0.1), 1e-9)) << ahead.eye_m.transpose();
  EXPECT_EQ(ahead.missed_m, 0.0);
}

TEST(EyeMoveTest, fades_to_the_pictures_own_eye_when_the_visitor_is_elsewhere) {
  EXPECT_NEAR(eye_move({0, 0, 0}, 0.0, {0.6, 0, 0}).eye_m.x(), 0.6, 1e-12);
  const EyeMove some = eye_move({0, 0, 0}, 0.0, {0.75, 0, 0});
  EXPECT_NEAR(some.eye_m.x(), 0.375, 1e-9);
  EXPECT_NEAR(some.missed_m, 0.375, 1e-9);
  const EyeMove none = eye_move({0, 0, 0}, 0.0, {5, 0, 0});
  EXPECT_TRUE(none.eye_m.isZero(0.0));
  EXPECT_EQ(none.missed_m, 5.0);
}

TEST(EyeMoveTest, is_exactly_zero_at_rest_and_for_a_pose_that_is_not_a_number) {
  EXPECT_TRUE(eye_move({1, 2, 3}, 1.0, {1, 2, 3}).eye_m.isZero(0.0));
  EXPECT_TRUE(eye_move({1, 2, 3}, 1.0, {1, std::nan(""), 3}).eye_m.isZero(0.0));
}

}  // namespace
}  // namespace cyclorama::display
