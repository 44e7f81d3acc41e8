// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/projection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace cyclorama {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kTiny = 1e-9;  // Metres or directions; rounding of about ten operations near 1 to 100.

/// One shape of each kind, with ordinary values and at the limits.
std::vector<PictureShape> shapes() {
  return {Panorama{2048, 768, 2.0 * kPi, 0.8, -0.6},
          Panorama{640, 480, 1e-3 * kDegree, 1e-5, -1e-5},
          Panorama{1, 1, 359.9 * kDegree, 100.0, 99.0},
          Perspective{1920, 1080, -0.9, 0.7, 0.2, -0.8, 0.3},
          Perspective::from_field(16384, 16384, 1e-3 * kDegree, 0.0),
          Perspective::from_field(800, 100, 179.0 * kDegree, -0.5 * kPi),
          Fisheye{1024, 1024, kPi, 0.5 * kPi},
          Fisheye{900, 700, 2.0 * kPi, 0.2},
          Fisheye{300, 16384, 1e-3 * kDegree, kPi},
          Fisheye{512, 512, 359.9 * kDegree, 0.0},
          Equirectangular{4096, 2048},
          Equirectangular{100, 50, 359.9 * kDegree, 0.3, 0.2},
          Equirectangular{500, 500, 1e-3 * kDegree, 0.5 * kPi, 0.5 * kPi - 1e-5}};
}

/// Pixels of the picture that have a direction.
std::vector<PanoramaPixel> places(const PictureShape& shape, int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.001, 0.999);
  std::vector<PanoramaPixel> found;
  while (static_cast<int>(found.size()) < count) {
    const PanoramaPixel p{unit(random) * width_px(shape), unit(random) * height_px(shape)};
    if (direction_at(shape, p)) found.push_back(p);
  }
  return found;
}

Projection stereo(const PictureShape& shape, Eyes eyes, double screen_m = 3.0) {
  Projection projection{shape, {}};
  projection.viewing.eyes = eyes;
  projection.viewing.eye_distance_m = 0.063;
  projection.viewing.screen_distance_m = screen_m;
  return projection;
}

/// Distance of a point from a line of sight.
double distance_to(const EyeRay& ray, const Eigen::Vector3d& point) {
  return (point - ray.origin).cross(ray.direction).norm();
}

/// Level shapes with the horizon in the middle, 90 degrees wide.
std::vector<PictureShape> level_shapes() {
  return {Panorama{1000, 500, 0.5 * kPi, 0.4, -0.4}, Perspective::from_field(1000, 500, 0.5 * kPi, 0.0),
          Fisheye{1000, 1000, 0.5 * kPi, 0.0}, Equirectangular{1000, 500, 0.5 * kPi, 0.4, -0.4}};
}

/// Column in which an eye sees a point straight ahead at that distance.
double column_of(const Projection& projection, double distance_m) {
  const Eigen::Vector3d point(0, 0, -distance_m);
  double left = 0.25 * projection.width_px();
  double right = 0.75 * projection.width_px();
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (left + right);
    const EyeRay ray = *projection.ray_at({middle, 0.5 * projection.height_px()});
    const bool passes_left = ray.direction.cross(point - ray.origin).y() < 0.0;
    (passes_left ? left : right) = middle;
  }
  return left;
}

TEST(Projection, pixel_and_direction_are_inverse_for_any_length) {
  for (const PictureShape& shape : shapes()) {
    ASSERT_TRUE(validate(shape).has_value()) << validate(shape).error().message();
    // Rounding of a coordinate near 1 moves a direction by 1e-16, which is many pixels of a picture this narrow.
    const double cone = std::max(1e-3 * kDegree / 16384, 1e-11);
    for (const PanoramaPixel& p : places(shape, 500)) {
      const auto back = pixel_of(shape, 7.5 * *direction_at(shape, p));
      ASSERT_TRUE(back.has_value()) << shape.index();
      EXPECT_NEAR(back->u, p.u, 1e-14 / cone * 10) << shape.index();
      EXPECT_NEAR(back->v, p.v, 1e-14 / cone * 10) << shape.index();
    }
  }
}

TEST(Projection, the_middle_of_every_level_picture_looks_along_the_heading) {
  for (const PictureShape& shape : level_shapes()) {
    const Eigen::Vector3d d = *direction_at(shape, {0.5 * width_px(shape), 0.5 * height_px(shape)});
    EXPECT_LT((d - Eigen::Vector3d(0, 0, -1)).norm(), kTiny);
    EXPECT_GT(direction_at(shape, {0.6 * width_px(shape), 0.5 * height_px(shape)})->x(), 0.05);
    EXPECT_GT(direction_at(shape, {0.5 * width_px(shape), 0.4 * height_px(shape)})->y(), 0.05);
  }
}

TEST(Projection, tilt_moves_the_middle_upwards) {
  const PictureShape fisheye = Fisheye{100, 100, 1.0, 0.3};
  const PictureShape perspective = Perspective::from_field(100, 100, 1.0, 0.3);
  for (const PictureShape& shape : {fisheye, perspective}) {
    const Eigen::Vector3d d = direction_at(shape, {50, 50})->normalized();
    EXPECT_LT((d - Eigen::Vector3d(0, std::sin(0.3), -std::cos(0.3))).norm(), kTiny);
  }
}

TEST(Projection, a_dome_master_has_the_zenith_in_the_middle_and_the_heading_at_its_lower_edge) {
  const Fisheye dome{2048, 2048, kPi, 0.5 * kPi};
  EXPECT_LT((*direction_at(dome, {1024, 1024}) - Eigen::Vector3d(0, 1, 0)).norm(), kTiny);
  EXPECT_LT((*direction_at(dome, {1024, 2048}) - Eigen::Vector3d(0, 0, -1)).norm(), kTiny);
  EXPECT_LT((*direction_at(dome, {2048, 1024}) - Eigen::Vector3d(1, 0, 0)).norm(), kTiny);
}

TEST(Projection, a_fisheye_shows_nothing_outside_its_circle) {
  const Fisheye wide{800, 600, 2.0 * kPi, 0.0};
  EXPECT_FALSE(direction_at(wide, {99.9, 300}).has_value());
  EXPECT_FALSE(direction_at(wide, {187, 87}).has_value());
  EXPECT_LT((*direction_at(wide, {100, 300}) - Eigen::Vector3d(0, 0, 1)).norm(), kTiny);  // Behind.
  const Fisheye half{600, 600, kPi, 0.0};
  EXPECT_LT((*direction_at(half, {600, 300}) - Eigen::Vector3d(1, 0, 0)).norm(), kTiny);
  EXPECT_FALSE(pixel_of(half, {1, 0, 0.001}).has_value());
}

TEST(Projection, there_is_no_pixel_for_invisible_directions) {
  EXPECT_FALSE(pixel_of(Panorama{10, 10, 1.0, 1.0, -1.0}, {0, 1, 0}).has_value());
  EXPECT_FALSE(pixel_of(Perspective::from_field(10, 10, 1.0, 0.0), {0, 0, 1}).has_value());
  EXPECT_FALSE(pixel_of(Perspective::from_field(10, 10, 1.0, 0.0), {1, 0, 0}).has_value());
}

TEST(Projection, the_edges_of_an_equirectangular_picture_are_the_poles) {
  const Equirectangular whole{360, 180};
  for (const double u : {0.0, 90.0, 359.5}) {
    EXPECT_LT((*direction_at(whole, {u, 0}) - Eigen::Vector3d(0, 1, 0)).norm(), kTiny);
    EXPECT_LT((*direction_at(whole, {u, 180}) - Eigen::Vector3d(0, -1, 0)).norm(), kTiny);
  }
  EXPECT_NEAR(pixel_of(whole, {0, 1, 0})->v, 0.0, kTiny);
}

TEST(Projection, both_eyes_look_through_the_same_point_of_the_screen) {
  for (const PictureShape& shape : shapes()) {
    for (const PanoramaPixel& p : places(shape, 100)) {
      const Eigen::Vector3d on_screen = 3.0 * *direction_at(shape, p);
      for (const Eyes eyes : {Eyes::kLeft, Eyes::kRight}) {
        const EyeRay ray = *stereo(shape, eyes).ray_at(p);
        EXPECT_LT(distance_to(ray, on_screen), kTiny * on_screen.norm()) << shape.index();
        EXPECT_NEAR(ray.direction.norm(), 1.0, kTiny);
      }
    }
  }
}

TEST(Projection, disparity_is_zero_on_the_screen_positive_behind_it_and_negative_in_front) {
  for (const PictureShape& shape : level_shapes()) {
    const auto disparity = [&](double distance_m) {
      return column_of(stereo(shape, Eyes::kRight), distance_m) - column_of(stereo(shape, Eyes::kLeft), distance_m);
    };
    EXPECT_NEAR(disparity(3.0), 0.0, 1e-6) << shape.index();
    EXPECT_GT(disparity(3.3), 0.5) << shape.index();
    EXPECT_GT(disparity(30.0), disparity(6.0)) << shape.index();
    EXPECT_LT(disparity(2.7), -0.5) << shape.index();
  }
}

TEST(Projection, at_infinity_the_disparity_is_the_eye_distance_on_the_screen) {
  const PictureShape wall = Perspective::from_field(1000, 500, 0.5 * kPi, 0.0);
  const double apart = column_of(stereo(wall, Eyes::kRight), 1e9) - column_of(stereo(wall, Eyes::kLeft), 1e9);
  EXPECT_NEAR(apart, 0.063 / 6.0 * 1000, 1e-4);  // The wall is 6 m wide.
}

TEST(Projection, eyes_stay_side_by_side_at_a_flat_screen_and_face_the_direction_at_a_round_one) {
  for (const PictureShape& shape : shapes()) {
    const bool flat = std::holds_alternative<Perspective>(shape);
    for (const PanoramaPixel& p : places(shape, 100)) {
      const Eigen::Vector3d apart =
          stereo(shape, Eyes::kRight).ray_at(p)->origin - stereo(shape, Eyes::kLeft).ray_at(p)->origin;
      const Eigen::Vector3d seen = direction_at(shape, p)->normalized();
      EXPECT_NEAR(apart.y(), 0.0, kTiny);
      if (flat) {
        EXPECT_LT((apart - Eigen::Vector3d(0.063, 0, 0)).norm(), kTiny);
      } else {
        EXPECT_NEAR(apart.dot(seen), 0.0, kTiny);
        EXPECT_GT(Eigen::Vector3d(-seen.z(), 0, seen.x()).dot(apart), 0.0);  // The right eye is on the right.
        EXPECT_LT(apart.norm(), 0.063 + kTiny);
        const double from_pole = std::hypot(seen.x(), seen.z());
        if (std::holds_alternative<Panorama>(shape) || from_pole > std::sin(30.0 * kDegree)) {
          EXPECT_NEAR(apart.norm(), 0.063, kTiny);
        }
      }
    }
  }
}

TEST(Projection, on_a_dome_the_eyes_come_together_towards_the_zenith) {
  Projection dome = stereo(Fisheye{1000, 1000, kPi, 0.5 * kPi}, Eyes::kRight);
  const auto aside = [&](double v) { return dome.ray_at({500, v})->origin.norm(); };
  EXPECT_NEAR(aside(500), 0.0, kTiny);
  EXPECT_GT(aside(550), 0.0);
  EXPECT_GT(aside(600), aside(550));
  EXPECT_NEAR(aside(700), 0.0315, kTiny);
  dome.viewing.pole_fade_rad = 0.0;
  EXPECT_NEAR(aside(501), 0.0315, kTiny);
  EXPECT_TRUE(dome.ray_at({500, 500})->direction.allFinite());
}

TEST(Projection, a_viewer_beside_the_sweet_spot_sees_the_screen_at_its_position) {
  for (const PictureShape& shape : shapes()) {
    Projection projection = stereo(shape, Eyes::kLeft);
    projection.viewing.viewer_m = {0.4, -0.2, 0.1};
    ASSERT_TRUE(projection.validate().has_value());
    for (const PanoramaPixel& p : places(shape, 50)) {
      const Eigen::Vector3d on_screen = 3.0 * *direction_at(shape, p);
      const EyeRay ray = *projection.ray_at(p);
      EXPECT_LT(distance_to(ray, on_screen), kTiny * on_screen.norm());
      EXPECT_LT((ray.origin - projection.viewing.viewer_m).norm(), 0.0315 + kTiny);
    }
  }
}

TEST(Projection, in_a_stacked_picture_the_left_eyes_is_above_the_right_eyes) {
  for (const PictureShape& shape : level_shapes()) {
    const Projection both = stereo(shape, Eyes::kOverUnder);
    EXPECT_EQ(both.height_px(), 2 * height_px(shape));
    EXPECT_EQ(both.width_px(), width_px(shape));
    for (const PanoramaPixel& p : places(shape, 50)) {
      const EyeRay upper = *both.ray_at(p);
      const EyeRay lower = *both.ray_at({p.u, p.v + height_px(shape)});
      EXPECT_EQ(upper.origin, stereo(shape, Eyes::kLeft).ray_at(p)->origin);
      EXPECT_LT((lower.origin - stereo(shape, Eyes::kRight).ray_at(p)->origin).norm(), kTiny);
      EXPECT_LT((lower.direction - stereo(shape, Eyes::kRight).ray_at(p)->direction).norm(), kTiny);
    }
  }
}

TEST(Projection, refuses_invalid_shapes_by_the_name_of_the_field) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const PictureShape& shape) {
    const Status status = validate(shape);
    return status ? std::string() : status.error().message();
  };
  using testing::HasSubstr;
  EXPECT_THAT(message(Panorama{0, 1, 1, 1, 0}), HasSubstr("width_px"));
  EXPECT_THAT(message(Perspective{10, 16385, -1, 1, 1, -1}), HasSubstr("height_px"));
  EXPECT_THAT(message(Perspective{10, 10, kNan, 1, 1, -1}), HasSubstr("tan_left"));
  EXPECT_THAT(message(Perspective{10, 10, 1, 1, 1, -1}), HasSubstr("tan_right"));
  EXPECT_THAT(message(Perspective{10, 10, -1, 1, -1, -1}), HasSubstr("tan_top"));
  EXPECT_THAT(message(Perspective{10, 10, -1, 1, 1, -1, kNan}), HasSubstr("tilt_rad"));
  EXPECT_THAT(message(Perspective::from_field(10, 10, kNan, 0.0)), HasSubstr("tan_left"));
  EXPECT_THAT(message(Fisheye{10, 10, 0.0}), HasSubstr("field_rad"));
  EXPECT_THAT(message(Fisheye{10, 10, 7.0}), HasSubstr("field_rad"));
  EXPECT_THAT(message(Fisheye{10, 10, kNan}), HasSubstr("field_rad"));
  EXPECT_THAT(message(Equirectangular{10, 10, 7.0}), HasSubstr("azimuth_span_rad"));
  EXPECT_THAT(message(Equirectangular{10, 10, 1.0, 1.6}), HasSubstr("elevation_top_rad"));
  EXPECT_THAT(message(Equirectangular{10, 10, 1.0, 1.0, -1.6}), HasSubstr("elevation_bottom_rad"));
  EXPECT_THAT(message(Equirectangular{10, 10, 1.0, 0.5, 0.5}), HasSubstr("elevation_top_rad"));
}

TEST(Projection, refuses_eyes_behind_the_screen_and_pictures_that_are_too_high) {
  const auto message = [](const Projection& projection) {
    const Status status = projection.validate();
    return status ? std::string() : status.error().message();
  };
  using testing::HasSubstr;
  const PictureShape panorama = Panorama{100, 9000, 1.0, 1.0, -1.0};
  EXPECT_EQ(message(stereo(panorama, Eyes::kLeft)), "");
  EXPECT_THAT(message(stereo(panorama, Eyes::kOverUnder)), HasSubstr("height_px"));
  EXPECT_THAT(message(stereo(panorama, Eyes::kLeft, 0.03)), HasSubstr("screen_distance_m"));
  EXPECT_THAT(message(stereo(panorama, Eyes::kLeft, -1.0)), HasSubstr("screen_distance_m"));
  EXPECT_THAT(message(stereo(panorama, Eyes::kLeft, std::numeric_limits<double>::quiet_NaN())),
              HasSubstr("screen_distance_m"));
  Projection projection = stereo(panorama, Eyes::kLeft);
  projection.viewing.eye_distance_m = -0.06;
  EXPECT_THAT(message(projection), HasSubstr("eye_distance_m"));
  projection = stereo(panorama, Eyes::kLeft);
  projection.viewing.pole_fade_rad = 2.0;
  EXPECT_THAT(message(projection), HasSubstr("pole_fade_rad"));
  projection = stereo(panorama, Eyes::kLeft);
  projection.viewing.viewer_m.z() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message(projection), HasSubstr("viewer_m"));
  projection = stereo(Perspective::from_field(10, 10, 1.0, 0.5 * kPi), Eyes::kMono);
  projection.viewing.viewer_m = {0, 3.1, 0};  // The screen is 3 m above.
  EXPECT_THAT(message(projection), HasSubstr("screen_distance_m"));
  projection.viewing.viewer_m = {0, 0, -3.1};
  EXPECT_EQ(message(projection), "");
}

}  // namespace
}  // namespace cyclorama
