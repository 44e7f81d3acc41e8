// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/picture_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace cyclorama {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<PictureShape> shapes() {
  return {Panorama{2048, 768, 2.0, 0.8, -0.6},
          Perspective{1920, 1080, -0.9, 0.7, 0.2, -0.8, 0.3},
          Perspective{1000, 1000, -100.0, 100.0, 100.0, -100.0, 0.0},
          Perspective{100, 100, -1.0, 1.0, 1.0, -1.0, 0.5 * kPi},
          Fisheye{1024, 1000, kPi, 0.5 * kPi},
          Fisheye{900, 700, 2.0 * kPi, 0.2},
          Equirectangular{4096, 2048}};
}

std::vector<Eigen::Vector3d> directions(int count) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> found;
  for (int i = 0; i < count; ++i) {
    found.push_back(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  }
  return found;
}

Eigen::Vector3d turned_right(const Eigen::Vector3d& d, double turn) {
  return Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitY()) * d;
}

TEST(PicturePlace, position_and_direction_are_inverse_inside_and_outside_the_picture) {
  int found = 0;
  for (const PictureShape& shape : shapes()) {
    for (const Eigen::Vector3d& d : directions(500)) {
      const auto place = place_of(shape, 3.0 * d);
      if (!place) continue;
      ++found;
      EXPECT_LT((direction_of(shape, *place).normalized() - d).norm(), 1e-13) << shape.index();
    }
  }
  EXPECT_GT(found, 2500);
}

TEST(PicturePlace, positions_are_linear_in_pixels_and_agree_with_the_picture) {
  for (const PictureShape& shape : shapes()) {
    const PixelScale scale = pixel_scale(shape);
    for (const Eigen::Vector3d& d : directions(500)) {
      const auto pixel = pixel_of(shape, d);
      if (!pixel) continue;
      const PanoramaPixel scaled = scale.pixel_at(*place_of(shape, d));
      EXPECT_NEAR(scaled.u, pixel->u, 1e-9 * (1.0 + std::abs(pixel->u)));
      EXPECT_NEAR(scaled.v, pixel->v, 1e-9 * (1.0 + std::abs(pixel->v)));
      const PanoramaPixel back = scale.pixel_at(scale.place_at(scaled));
      EXPECT_NEAR(back.u, scaled.u, 1e-9 * (1.0 + std::abs(pixel->u)));
    }
    EXPECT_NEAR(scale.distance_px(scale.place_at({10, 20}), scale.place_at({13, 24})), 5.0, 1e-9);
    EXPECT_LT(scale.v_per_up, 0.0);
  }
}

TEST(PicturePlace, has_edges_unless_the_picture_is_unlimited) {
  const Eigen::Vector3d up(0, 1, 0);
  const Eigen::Vector3d back(0, 0, 1);
  const Eigen::Vector3d right(1, 0, 0);
  EXPECT_FALSE(place_of(Panorama{16, 16, 1.0, 0.5, -0.5}, up));
  EXPECT_NEAR(place_of(Panorama{16, 16, 1.0, 0.5, -0.5}, back)->across, kPi, 1e-15);
  const PictureShape plane = Perspective{16, 16, -1.0, 1.0, 1.0, -1.0, 0.0};
  EXPECT_FALSE(place_of(plane, right));
  EXPECT_FALSE(place_of(plane, back));
  // 179 degrees across: positions far from the centre are still inverted correctly.
  const auto far = place_of(plane, {std::sin(0.4972 * kPi), 0.0, -std::cos(0.4972 * kPi)});
  ASSERT_TRUE(far);
  EXPECT_GT(far->across, 100.0);
  const PictureShape narrow = Fisheye{16, 16, 1.0, 0.0};
  EXPECT_NEAR(place_of(narrow, right)->across, 0.5 * kPi, 1e-15);  // Outside its field.
  // The antipode corresponds to the whole largest circle.
  EXPECT_FALSE(place_of(narrow, back));
  EXPECT_NEAR(place_of(narrow, {1e-9, 0.0, 1.0})->across, kPi, 1e-8);
  EXPECT_EQ(place_of(narrow, {0.0, 0.0, -2.0}), PicturePlace{});
}

TEST(PicturePlace, turning_moves_a_position_to_the_turned_direction) {
  for (const PictureShape& shape : shapes()) {
    for (const double turn : {-0.5, -1e-6, 0.0, 0.14, 1.0}) {
      for (const Eigen::Vector3d& d : directions(100)) {
        const auto place = place_of(shape, d);
        if (!place) continue;
        const auto moved = turned(shape, *place, turn);
        const auto wanted = place_of(shape, turned_right(d, turn));
        ASSERT_EQ(moved.has_value(), wanted.has_value());
        if (!moved) continue;
        EXPECT_LT((direction_of(shape, *moved).normalized() - turned_right(d, turn)).norm(), 1e-12);
      }
    }
  }
}

TEST(PicturePlace, turning_a_panorama_is_an_exact_shift) {
  const auto moved = turned(Panorama{16, 16, 1.0, 0.5, -0.5}, {0.25, 0.5}, 0.125);
  EXPECT_EQ(moved, (PicturePlace{0.375, 0.5}));
}

TEST(PicturePlace, turning_a_dome_master_rotates_it_about_its_centre) {
  const PictureShape dome = Fisheye{1024, 1024, kPi, 0.5 * kPi};
  const auto heading = turned(dome, {0.0, -0.5 * kPi}, 0.5 * kPi);
  EXPECT_NEAR(heading->across, 0.5 * kPi, 1e-12);  // The direction that is now ahead was on the right.
  EXPECT_NEAR(heading->up, 0.0, 1e-12);
}

TEST(PicturePlace, is_the_same_in_pictures_of_one_kind_and_tilt) {
  for (const PictureShape& shape : shapes()) {
    const PictureShape larger = with_pixels(shape, 1234, 567);
    EXPECT_EQ(width_px(larger), 1234);
    EXPECT_EQ(height_px(larger), 567);
    EXPECT_EQ(with_pixels(larger, width_px(shape), height_px(shape)), shape);
    EXPECT_TRUE(has_same_places(shape, larger));
  }
  EXPECT_TRUE(has_same_places(Fisheye{64, 64, 3.0, 0.5}, Fisheye{64, 64, 2.0, 0.5}));
  EXPECT_FALSE(has_same_places(Fisheye{64, 64, 3.0, 0.5}, Fisheye{64, 64, 3.0, 0.4}));
  EXPECT_FALSE(has_same_places(Panorama{64, 64, 1.0, 0.5, -0.5}, Perspective{64, 64, -1.0, 1.0, 1.0, -1.0, 0.0}));
}

}  // namespace
}  // namespace cyclorama
