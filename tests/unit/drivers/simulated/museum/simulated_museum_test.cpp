// SPDX-License-Identifier: Apache-2.0
// Tests each effect alone, in an otherwise perfect room, against a closed form or an independent computation.
#include "drivers/simulated/museum/simulated_museum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDistance_m = 4.0;

/// A flat wall that a projector and a camera face side by side.
constexpr const char* kRoom = R"(
name = "one projector on a plane"
[wall]
shape = "plane"
centre_m = [0, 1.6, -4]
width_m = 8
height_m = 6
[visitor]
eye_m = [0, 1.6, 0]
[[projector]]
name = "one"
width_px = 320
height_px = 180
field_of_view_deg = 45
position_m = [0, 1.6, 0]
)";

struct Room {
  Installation installation = *parse_installation(kRoom, "room");
  MuseumTruth truth = MuseumTruth::ideal(installation);

  Room() {
    truth.cells = 0;
    truth.camera.lens = TrueLens(Pinhole::from_field_of_view(400, 300, 50.0 * kPi / 180.0));
    truth.camera.bits = 16;
    truth.camera.full_well_e = 60000.0;
  }
  [[nodiscard]] SimulatedMuseum museum() const { return *SimulatedMuseum::make(installation, truth); }
  [[nodiscard]] TrueMuseum light() const { return *TrueMuseum::make(installation, truth); }
};

RgbImage white() { return RgbImage(320, 180, 255); }

RgbImage dot(int x, int y) {
  RgbImage picture(320, 180, 0);
  for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = 255;
  return picture;
}

Eigen::Vector2d centroid(const GreyPhotograph& photograph) {
  double sum = 0.0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  for (int y = 0; y < photograph.height(); ++y) {
    for (int x = 0; x < photograph.width(); ++x) {
      const double value = *photograph.at(x, y);
      sum += value;
      at += value * Eigen::Vector2d(x + 0.5, y + 0.5);
    }
  }
  return at / sum;
}

GreyPhotograph photograph(const Room& room, const RgbImage& picture, double exposure_s = 0.05) {
  SimulatedMuseum museum = room.museum();
  EXPECT_TRUE(museum.show(0, picture));
  museum.settle();
  return *museum.photograph_grey(exposure_s);
}

// --- Geometry ---

TEST(SimulatedMuseum, images_a_pixel_through_both_distorted_lenses) {
  Room room;
  const TrueLens projector(room.installation.projectors[0].lens, {-0.12, 0.03, 0.0}, {0.002, -0.001});
  const TrueLens camera(Pinhole::from_field_of_view(400, 300, 50.0 * kPi / 180.0), {-0.2, 0.05, 0.0}, {-0.001, 0.002});
  room.truth.projectors[0].lens = projector;
  room.truth.camera.lens = camera;
  room.truth.projectors[0].T_room_projector = {room.truth.projectors[0].T_room_projector.rotation(), {0.3, 1.8, 0.1}};
  // Blur gives a dot a centre between pixels, in the camera and in the sampling.
  room.truth.camera.blur_px = 0.7;
  room.truth.projectors[0].blur_px = 0.8;
  for (const auto& [x, y] : {std::pair(20, 30), std::pair(300, 20), std::pair(160, 90), std::pair(250, 170)}) {
    // Computed by hand: the projector's ray, the plane z = -4, the camera's lens. Both look along -z, so y and z change
    // sign.
    const Eigen::Vector3d ray = *projector.direction_at(x + 0.5, y + 0.5);
    const double along = (kDistance_m + 0.1) / ray.z();
    const Eigen::Vector3d on_wall(0.3 + along * ray.x(), 1.8 - along * ray.y(), -kDistance_m);
    const Eigen::Vector2d expected = *camera.pixel_of({on_wall.x(), -(on_wall.y() - 1.6), kDistance_m});
    EXPECT_LT((centroid(photograph(room, dot(x, y), 0.1)) - expected).norm(), 0.02) << x << ", " << y;
  }
}

TEST(SimulatedMuseum, lens_shift_moves_the_picture_and_keeps_it_rectangular) {
  Room room;
  Pinhole shifted = room.installation.projectors[0].lens;
  shifted.centre_v_px += 0.4 * shifted.height_px;
  room.truth.projectors[0].lens = TrueLens(shifted);
  const TrueMuseum museum = room.light();
  const auto corner = [&](double u, double v) { return museum.wall_at(0, u, v)->point.xyz; };
  EXPECT_NEAR((corner(0, 0) - corner(320, 0)).norm(), (corner(0, 180) - corner(320, 180)).norm(), 1e-12);
  const double height = corner(0, 0).y() - corner(0, 180).y();
  EXPECT_NEAR(0.5 * (corner(0, 0).y() + corner(0, 180).y()) - 1.6, 0.4 * height, 1e-9);
}

TEST(SimulatedMuseum, scoring_inverts_the_projection_everywhere) {
  Room room;
  room.truth.projectors[0].lens = TrueLens(room.installation.projectors[0].lens, {-0.1, 0.02, 0.0}, {0.001, 0.001});
  const TrueMuseum museum = room.light();
  for (double v = 3.0; v < 180.0; v += 29.0) {
    for (double u = 2.0; u < 320.0; u += 37.0) {
      const auto at = museum.wall_at(0, u, v);
      ASSERT_TRUE(at);
      EXPECT_LT((*museum.projector_pixel(0, *at) - Eigen::Vector2d(u, v)).norm(), 1e-9);
      const Eigen::Vector3d direction = *museum.direction_at(0, u, v, room.installation.sweet_spot);
      EXPECT_LT(direction.cross(at->point.xyz - room.installation.sweet_spot.xyz).norm(), 1e-12);
    }
  }
}

TEST(SimulatedMuseum, turns_the_camera_about_a_leaning_axis_beside_it) {
  Room room;
  const Eigen::Quaterniond leaning(Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.6, 0.0, 0.8)));
  room.truth.turntable.T_room_turntable = {leaning, {0.02, 1.5, -0.01}};
  room.truth.turntable.T_turntable_camera = {room.truth.turntable.T_turntable_camera.rotation(), {0.03, 0.1, -0.04}};
  const TrueMuseum museum = room.light();
  const Eigen::Vector3d axis = leaning * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d middle = museum.turning_point().xyz;
  for (const double angle : {-2.0, -0.3, 0.0, 0.7, 3.0}) {
    const auto pose = museum.camera_pose(angle);
    // Rodrigues' formula about the axis, to the right, that is, opposite to a right-handed rotation about an upward
    // axis.
    const Eigen::Vector3d start = museum.camera_pose(0.0).translation() - middle;
    const Eigen::Vector3d turned = start * std::cos(angle) - axis.cross(start) * std::sin(angle) +
                                   axis * axis.dot(start) * (1.0 - std::cos(angle));
    EXPECT_LT((pose.translation() - middle - turned).norm(), 1e-12);
    EXPECT_NEAR(start.norm(), 0.05, 1e-12);
  }
  // A turn to the right moves the camera's line of sight towards +x.
  EXPECT_GT((museum.camera_pose(0.3).rotation() * Eigen::Vector3d::UnitZ()).x(), 0.2);
}

TEST(SimulatedMuseum, the_turntable_has_the_errors_of_its_gear) {
  Room room;
  room.truth.turntable.scale_error = 0.001;
  room.truth.turntable.wobble_rad = 0.002;
  room.truth.turntable.backlash_rad = 0.0004;
  SimulatedMuseum museum = room.museum();
  museum.turn_to(1.0);
  EXPECT_NEAR(museum.true_turntable_angle_rad(), 1.001 + 0.002 * std::sin(1.0) - 0.0002, 1e-12);
  museum.turn_to(0.5);
  EXPECT_NEAR(museum.true_turntable_angle_rad(), 0.5005 + 0.002 * std::sin(0.5) + 0.0002, 1e-12);
  EXPECT_EQ(museum.turntable_angle_rad(), 0.5);

  room.truth.turntable = TrueTurntable{};
  room.truth.turntable.T_room_turntable = Room().truth.turntable.T_room_turntable;
  room.truth.turntable.T_turntable_camera = Room().truth.turntable.T_turntable_camera;
  room.truth.turntable.jitter_rad = 0.001;
  SimulatedMuseum shaking = room.museum();
  constexpr int kStops = 2000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kStops; ++i) {
    shaking.turn_to(0.01 * i);
    const double off = (shaking.true_turntable_angle_rad() - 0.01 * i) / 0.001;
    sum += off;
    squares += off * off;
  }
  EXPECT_LT(std::abs(sum) / std::sqrt(kStops), 4.5);
  EXPECT_LT(std::abs(squares / kStops - 1.0) / std::sqrt(2.0 / kStops), 4.5);
}

// --- Light ---

// On a wall that faces it, a projector whose pixels all have the same flux falls off by its vignetting alone: the loss
// of a tilted ray by distance and slope equals the gain by its pixels' density in angle.
TEST(SimulatedMuseum, vignetting_is_a_power_of_the_cosine) {
  for (const double exponent : {0.0, 4.0}) {
    Room room;
    room.truth.projectors[0].vignetting_exponent = exponent;
    const TrueMuseum museum = room.light();
    const double middle = museum.gain_lux(0, *museum.wall_at(0, 160, 90));
    for (const double u : {1.0, 80.0, 300.0}) {
      const Eigen::Vector3d ray = room.installation.projectors[0].lens.direction_at(u, 20.0);
      const double cosine = 1.0 / ray.norm();
      EXPECT_NEAR(museum.gain_lux(0, *museum.wall_at(0, u, 20.0)) / middle, std::pow(cosine, exponent), 1e-9);
    }
  }
}

TEST(SimulatedMuseum, the_cameras_own_vignetting_is_a_power_of_the_cosine) {
  Room room;
  room.truth.ambient_lux = {100.0, 100.0, 100.0};
  room.truth.camera.vignetting_exponent = 4.0;
  SimulatedMuseum museum = room.museum();
  const GreyPhotograph seen = *museum.photograph_grey(0.1);
  const Pinhole& lens = room.truth.camera.lens.pinhole();
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(100, 250), std::pair(399, 150)}) {
    const double cosine = 1.0 / lens.direction_at(x + 0.5, y + 0.5).norm();
    const double middle = 1.0 / lens.direction_at(200.5, 150.5).norm();
    EXPECT_NEAR(static_cast<double>(*seen.at(x, y)) / *seen.at(200, 150), std::pow(cosine / middle, 4.0), 1e-3);
  }
}

TEST(SimulatedMuseum, all_lumens_reach_the_wall_for_any_distortion) {
  for (const double k1 : {0.0, -0.15, 0.2}) {
    Room room;
    room.truth.projectors[0].lens = TrueLens(room.installation.projectors[0].lens, {k1, 0.0, 0.0});
    const TrueMuseum museum = room.light();
    // Integrates irradiance over the picture's area on the wall by the midpoint rule.
    constexpr int kColumns = 800;
    constexpr int kRows = 600;
    double lumens = 0.0;
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i) {
        const auto at = museum.wall().at({0, (i + 0.5) / kColumns, (j + 0.5) / kRows});
        const auto pixel = museum.projector_pixel(0, at);
        if (pixel && room.installation.projectors[0].lens.contains(*pixel))
          lumens += museum.gain_lux(0, at) * 48.0 / kColumns / kRows;
      }
    }
    EXPECT_NEAR(lumens, 3000.0, 12.0);
  }
}

TEST(SimulatedMuseum, wall_cells_receive_the_walls_light) {
  Room room;
  room.truth.cells = 300;
  const TrueMuseum museum = room.light();
  const auto direct = museum.direct_light(0, white());
  double lumens = 0.0;
  for (std::size_t i = 0; i < direct.size(); ++i) lumens += direct[i][1] * museum.inter_reflection()->areas_m2()[i];
  EXPECT_NEAR(lumens, 3000.0, 1e-6);
}

TEST(SimulatedMuseum, a_photograph_shows_the_true_radiance) {
  Room room;
  room.truth.cells = 200;
  room.truth.ambient_lux = {3.0, 2.0, 1.0};
  room.truth.albedo = {0.8, 0.6, 0.7};
  room.truth.projectors[0].primaries = {{{0.9, 0.05, 0.02}, {0.1, 1.0, 0.03}, {0.02, 0.08, 0.95}}};
  room.truth.camera.sensitivity = {{{0.9, 0.1, 0.0}, {0.05, 0.8, 0.1}, {0.0, 0.1, 0.7}}};
  SimulatedMuseum museum = room.museum();
  RgbImage picture(320, 180);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      picture.at(x, y)[0] = static_cast<std::uint8_t>(60 + y);  // Linear slopes, which sampling does not blur.
      picture.at(x, y)[1] = static_cast<std::uint8_t>(200 - y);
      picture.at(x, y)[2] = 130;
    }
  }
  ASSERT_TRUE(museum.show(0, picture));
  museum.settle();
  const RgbPhotograph seen = *museum.photograph_colour(0.1);
  const double per_code = 60000.0 / 65535.0 / (3000.0 * 0.1);
  const auto pose = museum.truth().camera_pose(0.0);
  for (const auto& [x, y] : {std::pair(120, 100), std::pair(200, 150), std::pair(290, 180), std::pair(10, 290)}) {
    const auto at = museum.truth().wall().hit(
        {{pose.translation()}, pose.rotation() * *room.truth.camera.lens.direction_at(x + 0.5, y + 0.5)});
    ASSERT_TRUE(at);
    const RoomColour nits = museum.truth().radiance_at(*at, std::vector{picture});
    for (std::size_t c = 0; c < 3; ++c) {
      double expected = 0.0;
      for (std::size_t r = 0; r < 3; ++r) expected += room.truth.camera.sensitivity[c][r] * nits[r];
      EXPECT_NEAR(seen.at(x, y)[c] * per_code, expected, 2e-3 * expected + per_code);
    }
  }
}

TEST(SimulatedMuseum, light_of_two_pictures_adds_up_with_their_black_levels) {
  Room room;
  room.truth.projectors[0].black = {0.001, 0.002, 0.003};
  room.truth.projectors[0].response[1] = {2.2, 0.0, 1.0, 0.0};
  const TrueMuseum museum = room.light();
  EXPECT_NEAR(museum.colour_of(0, {0, 0, 0})[2], 0.003, 1e-12);
  EXPECT_NEAR(museum.colour_of(0, {255, 255, 255})[1], 1.0, 1e-12);
  EXPECT_NEAR(museum.colour_of(0, {0, 128, 0})[1], 0.002 + 0.998 * std::pow(128.0 / 255.0, 2.2), 1e-12);
  const GreyPhotograph dark = photograph(room, RgbImage(320, 180, 0), 1.0);
  const GreyPhotograph off = photograph(room, {}, 1.0);
  EXPECT_EQ(*off.at(200, 150), 0);
  const double black_level = 0.2126 * 0.001 + 0.7152 * 0.002 + 0.0722 * 0.003;
  const auto at = *museum.wall_at(0, 160.4, 90.4);
  EXPECT_NEAR(*dark.at(200, 150), museum.gain_lux(0, at) * black_level * 0.8 / kPi * 3000.0 / 60000.0 * 65535.0, 2.0);
}

// --- Sharpness ---

/// Returns the variance across the camera's picture of a bright column, in camera pixels squared.
double spread(const Room& room, int column) {
  RgbImage picture(320, 180, 0);
  for (int y = 0; y < 180; ++y) {
    for (int c = 0; c < 3; ++c) picture.at(column, y)[c] = 255;
  }
  const GreyPhotograph seen = photograph(room, picture, 0.1);
  double sum = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (int x = 0; x < seen.width(); ++x) {
    const double value = *seen.at(x, 150);
    sum += value;
    first += value * x;
    second += value * x * x;
  }
  return second / sum - first / sum * (first / sum);
}

TEST(SimulatedMuseum, variances_of_blurs_add_up) {
  Room room;
  room.truth.camera.lens = TrueLens(Pinhole::from_field_of_view(800, 300, 45.0 * kPi / 180.0));
  room.truth.projectors[0].blur_px = 0.5;
  const double zoom = 800.0 / 320.0;  // Camera pixels per projector pixel.
  const double sharp = spread(room, 160);
  EXPECT_NEAR(sharp, zoom * zoom * 0.25 + 1.0 / 12.0, 0.12);
  room.truth.camera.blur_px = 1.5;
  EXPECT_NEAR(spread(room, 160) - sharp, 2.25, 0.03);
  room.truth.camera.blur_px = 0.0;
  room.truth.projectors[0].blur_px = 1.2;
  EXPECT_NEAR(spread(room, 160) - sharp, zoom * zoom * (1.44 - 0.25), 0.1);
  // Defocus: 20 px per dioptre, focused at 5 m, the wall at 4 m: 1 px.
  room.truth.projectors[0].focus_distance_m = 5.0;
  room.truth.projectors[0].defocus_px_per_dioptre = 20.0;
  EXPECT_NEAR(spread(room, 160) - sharp, zoom * zoom * (1.44 - 0.25 + 1.0), 0.15);
}

// --- Time ---

TEST(SimulatedMuseum, a_rolling_shutter_sees_a_change_row_by_row) {
  Room room;
  room.truth.ambient_lux = {0.0, 0.0, 0.0};
  room.truth.camera.line_time_s = 1e-4;
  room.truth.projectors[0].latency_s = 0.015;
  SimulatedMuseum museum = room.museum();
  ASSERT_TRUE(museum.show(0, white()));
  // Row y is exposed from 0.1 y ms for 10 ms; light comes at 15 ms.
  const GreyPhotograph torn = *museum.photograph_grey(0.01);
  EXPECT_NEAR(museum.now_s(), 0.01 + 299e-4, 1e-12);
  const GreyPhotograph lit = *museum.photograph_grey(0.01);
  for (int y = 60; y < 240; y += 10) {
    const double expected = std::clamp((1e-4 * y + 0.01 - 0.015) / 0.01, 0.0, 1.0);
    EXPECT_NEAR(*torn.at(200, y) / static_cast<double>(*lit.at(200, y)), expected, 2e-3) << y;
  }
}

TEST(SimulatedMuseum, a_global_shutter_that_is_early_sees_the_previous_picture) {
  Room room;
  room.truth.projectors[0].latency_s = 0.05;
  SimulatedMuseum museum = room.museum();
  ASSERT_TRUE(museum.show(0, white()));
  EXPECT_EQ(*museum.photograph_grey(0.01)->at(200, 150), 0);
  museum.settle();
  EXPECT_GT(*museum.photograph_grey(0.01)->at(200, 150), 100);
  ASSERT_TRUE(museum.show(0, {}));
  museum.wait(0.02);
  EXPECT_GT(*museum.photograph_grey(0.01)->at(200, 150), 100);
}

// --- Errors and determinism ---

TEST(SimulatedMuseum, is_deterministic_for_any_number_of_threads) {
  Room room;
  room.truth.camera.has_shot_noise = true;
  room.truth.cells = 60;
  std::vector<GreyPhotograph> seen;
  for (const int threads : {1, 2, 3}) {
    SimulatedMuseum museum = *SimulatedMuseum::make(room.installation, room.truth, threads);
    museum.turn_to(0.1);
    ASSERT_TRUE(museum.show(0, white()));
    museum.settle();
    ASSERT_TRUE(museum.photograph_grey(0.01));
    seen.push_back(*museum.photograph_grey(0.01));
  }
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_EQ(seen[0], seen[2]);
}

TEST(SimulatedMuseum, refuses_impossible_requests) {
  Room room;
  SimulatedMuseum museum = room.museum();
  EXPECT_FALSE(museum.show(1, white()));
  EXPECT_FALSE(museum.show(0, RgbImage(10, 10)));
  EXPECT_FALSE(museum.photograph_grey(0.0));
  EXPECT_FALSE(museum.photograph_grey(std::nan("")));
  Room two = room;
  two.truth.projectors.push_back(two.truth.projectors[0]);
  EXPECT_FALSE(SimulatedMuseum::make(two.installation, two.truth));
  Room behind = room;
  behind.truth.turntable.T_room_turntable = {Eigen::Quaterniond::Identity(), {0.0, 1.6, -6.0}};
  EXPECT_FALSE(SimulatedMuseum::make(behind.installation, behind.truth));
}

TEST(SimulatedMuseum, eight_bit_pictures_of_any_camera_range_from_0_to_255) {
  GreyPhotograph photograph(3, 1);
  *photograph.at(1, 0) = 2048;
  *photograph.at(2, 0) = 4095;
  const GreyImage picture = to_8_bits(photograph, 12);
  EXPECT_EQ(*picture.at(0, 0), 0);
  EXPECT_EQ(*picture.at(1, 0), 128);
  EXPECT_EQ(*picture.at(2, 0), 255);
}

}  // namespace
}  // namespace cyclorama::simulated
