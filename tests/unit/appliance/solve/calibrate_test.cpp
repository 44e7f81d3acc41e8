// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/data_sets/generated_room.h"

namespace cyclorama::solve {
namespace {

RoomPlan coarse_plan(RoomKind kind, double noise_px = 0.2) {
  RoomPlan plan;
  plan.kind = kind;
  plan.stride_px = 12;
  plan.noise_px = noise_px;
  return plan;
}

RegistrationScore score_of(const GeneratedRoom& room, const calibration::Calibration& calibration) {
  return registration_score(
      room, [&](std::size_t p, const Eigen::Vector2d& px) { return calibration.projectors[p].map.direction_at(px); });
}

TEST(Calibrate, keeps_a_map_that_predicts_better_than_the_new_one) {
  CalibrateOptions options;
  options.with_wall = false;
  const GeneratedRoom room(coarse_plan(RoomKind::kCylinder, 0.05));
  const auto good = calibrate(room.measurements(), "2026-01-01T00-00-00Z", options);
  ASSERT_TRUE(good) << good.error().message();
  options.previous = &*good;
  const auto noisy =
      calibrate(GeneratedRoom(coarse_plan(RoomKind::kCylinder, 3.0)).measurements(), "2026-01-02T00-00-00Z", options);
  ASSERT_TRUE(noisy) << noisy.error().message();
  const double before = score_of(room, *good).p95_px;
  EXPECT_LE(score_of(room, *noisy).p95_px, 1.2 * before + 0.01);
  EXPECT_TRUE(noisy->projectors[0].is_previous);
}

/// Simulates a bump of a projector: its picture is shifted on the wall.
void knock(Measurements* measured, std::uint32_t projector, float by_px) {
  for (TurntableDirection& direction : measured->directions) {
    for (Correspondence& c : direction.correspondences) {
      if (c.projector == projector) c.projector_x += by_px;
    }
  }
}

TEST(Calibrate, is_never_worse_after_a_noisy_scan_that_cannot_locate_the_camera) {
  CalibrateOptions options;
  options.with_wall = false;
  for (const double incidence : {30.0, 75.0}) {
    RoomPlan plan = coarse_plan(RoomKind::kPlane);
    plan.arc_rad = 0.8;
    plan.throw_ratio = 1.2;
    plan.projectors = 2;
    plan.stride_px = 10;
    plan.aim_off_rad = std::tan(incidence * 0.0174533);
    const GeneratedRoom room(plan);
    options.previous = nullptr;
    const auto good = calibrate(room.measurements(), "2026-01-01T00-00-00Z", options);
    ASSERT_TRUE(good) << good.error().message();
    plan.noise_px = 1.6;
    options.previous = &*good;
    const auto noisy = calibrate(GeneratedRoom(plan).measurements(), "2026-01-02T00-00-00Z", options);
    ASSERT_TRUE(noisy) << noisy.error().message();
    const RegistrationScore before = score_of(room, *good);
    const RegistrationScore after = score_of(room, *noisy);
    std::string remarks = noisy->turntable.offset_reason + "\nbefore: " + good->turntable.offset_reason;
    for (const std::string& remark : noisy->remarks) remarks += "\n" + remark;
    for (const calibration::CalibratedProjector& p : noisy->projectors) {
      remarks += "\n" + p.name + (p.is_previous ? " keeps its map" : " has a new map");
    }
    EXPECT_LE(after.p95_px, 1.2 * before.p95_px + 0.01) << remarks;
    EXPECT_LE(after.true_p95_px, 1.2 * before.true_p95_px + 0.01) << remarks;
  }
}

TEST(Calibrate, is_never_worse_after_a_noisy_scan_of_a_few_degrees) {
  // All previous maps narrowly fail the new measurements, which determine the camera's lens and the angles badly.
  CalibrateOptions options;
  options.with_wall = false;
  for (const auto& [arc_deg, seed] : {std::pair(5.0, 1U), std::pair(15.0, 5U), std::pair(45.0, 4U)}) {
    RoomPlan plan;
    plan.seed = seed;
    plan.stride_px = 10;
    plan.arc_rad = arc_deg * 0.0174533;
    plan.projectors = 2;
    plan.half_height_m = 4.0 * std::tan(std::min(0.33, 0.4 * plan.arc_rad));
    plan.turntable_step_rad = std::min(0.5, std::max(0.05, 0.4 * plan.arc_rad));
    const GeneratedRoom room(plan);
    options.previous = nullptr;
    const auto good = calibrate(room.measurements(), "2026-01-01T00-00-00Z", options);
    ASSERT_TRUE(good) << good.error().message();
    plan.noise_px = 3.0 * plan.noise_px + 1.0;
    options.previous = &*good;
    const auto noisy = calibrate(GeneratedRoom(plan).measurements(), "2026-01-02T00-00-00Z", options);
    ASSERT_TRUE(noisy) << noisy.error().message();
    EXPECT_LE(score_of(room, *noisy).p95_px, 1.2 * score_of(room, *good).p95_px + 0.01) << arc_deg;
  }
}

TEST(Calibrate, makes_a_new_map_for_a_bumped_projector_that_fits_the_others) {
  CalibrateOptions options;
  options.with_wall = false;
  RoomPlan plan = coarse_plan(RoomKind::kCylinder);
  const GeneratedRoom room(plan);
  const auto good = calibrate(room.measurements(), "2026-01-01T00-00-00Z", options);
  ASSERT_TRUE(good) << good.error().message();
  plan.noise_px = 0.3;
  Measurements knocked = GeneratedRoom(plan).measurements();
  constexpr float kBump_px = 3.0f;
  knock(&knocked, 1, kBump_px);
  options.previous = &*good;
  const auto healed = calibrate(knocked, "2026-01-02T00-00-00Z", options);
  ASSERT_TRUE(healed) << healed.error().message();
  EXPECT_TRUE(healed->projectors[0].is_previous);
  EXPECT_FALSE(healed->projectors[1].is_previous);
  EXPECT_TRUE(healed->projectors[2].is_previous);
  const RegistrationScore score = registration_score(room, [&](std::size_t p, const Eigen::Vector2d& px) {
    const Eigen::Vector2d moved = px + Eigen::Vector2d(p == 1 ? static_cast<double>(kBump_px) : 0.0, 0.0);
    return healed->projectors[p].map.direction_at(moved);
  });
  EXPECT_LE(score.p95_px, 0.2);
}

TEST(Calibrate, replaces_a_map_with_a_hole_even_if_the_rest_is_right) {
  CalibrateOptions options;
  options.with_wall = false;
  RoomPlan plan = coarse_plan(RoomKind::kCylinder);
  auto good = calibrate(GeneratedRoom(plan).measurements(), "2026-01-01T00-00-00Z", options);
  ASSERT_TRUE(good) << good.error().message();
  calibration::MeasuredMap& map = good->projectors[1].map;
  for (int y = map.cells_y / 3; y < map.cells_y / 2; ++y) {
    for (int x = map.cells_x / 3; x < map.cells_x / 2; ++x) {
      map.directions[static_cast<std::size_t>(y * (map.cells_x + 1) + x)].setConstant(
          std::numeric_limits<double>::quiet_NaN());
    }
  }
  plan.noise_px = 0.3;  // The noise alone would be no reason for another map.
  options.previous = &*good;
  const auto anew = calibrate(GeneratedRoom(plan).measurements(), "2026-01-02T00-00-00Z", options);
  ASSERT_TRUE(anew) << anew.error().message();
  EXPECT_TRUE(anew->projectors[0].is_previous);
  EXPECT_FALSE(anew->projectors[1].is_previous);
}

TEST(Calibrate, replaces_maps_with_parallax_once_the_camera_is_located) {
  CalibrateOptions options;
  options.with_wall = false;
  const auto rough =
      calibrate(GeneratedRoom(coarse_plan(RoomKind::kCylinder, 3.0)).measurements(), "2026-01-01T00-00-00Z", options);
  ASSERT_TRUE(rough) << rough.error().message();
  options.previous = &*rough;
  const GeneratedRoom room(coarse_plan(RoomKind::kCylinder, 0.05));
  const auto fine = calibrate(room.measurements(), "2026-01-02T00-00-00Z", options);
  ASSERT_TRUE(fine) << fine.error().message();
  for (const calibration::CalibratedProjector& projector : fine->projectors) EXPECT_FALSE(projector.is_previous);
  EXPECT_LE(score_of(room, *fine).true_p95_px, 0.5);
}

TEST(Calibrate, is_accurate_in_a_corner_that_harmonics_cannot_represent) {
  RoomPlan plan = coarse_plan(RoomKind::kCorner);
  plan.arc_rad = 1.5;
  const GeneratedRoom room(plan);
  const auto calibration = calibrate(room.measurements(), "2026-01-01T00-00-00Z");
  ASSERT_TRUE(calibration) << calibration.error().message();
  EXPECT_TRUE(calibration->turntable.wall.has_value());
  // The wall is a profile here, which rounds the crease by its knots; harmonics alone have an error of 4.8 px.
  EXPECT_LE(score_of(room, *calibration).true_p95_px, 0.9) << calibration->turntable.offset_reason;
}

TEST(Calibrate, finds_a_wall_that_is_right_for_another_eye) {
  const GeneratedRoom room(coarse_plan(RoomKind::kCylinder));
  const auto calibration = calibrate(room.measurements(), "2026-01-01T00-00-00Z");
  ASSERT_TRUE(calibration) << calibration.error().message();
  ASSERT_TRUE(calibration->wall) << calibration->remarks.back();
  EXPECT_EQ(calibration->wall->fit.surface.model, calibration::SurfaceModel::kCylinder) << calibration->wall->reason;
  // The given distance of the wall sets the scale, in which the eye moves.
  const calibration::Surface& wall = calibration->wall->fit.surface;
  const double scale = wall.distance_m * [&] {
    const auto point = room.wall_point_of(1, {960.0, 540.0});
    return 1.0 / point->norm();
  }();
  const Eigen::Vector3d eye(0.3, 0.1, -0.4);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(400.0, 500.0), Eigen::Vector2d(1500.0, 600.0)}) {
    const calibration::MeasuredMap moved = seen_from(calibration->projectors[1].map, wall, scale * eye);
    const auto point = room.wall_point_of(1, pixel);
    const auto seen = moved.direction_at(pixel);
    ASSERT_TRUE(point && seen);
    EXPECT_LE((*seen - (*point - eye).normalized()).norm(), 0.02);
  }
}

TEST(Calibrate, names_a_projector_that_was_not_seen) {
  Measurements measured = GeneratedRoom(coarse_plan(RoomKind::kCylinder)).measurements();
  for (TurntableDirection& direction : measured.directions) {
    std::erase_if(direction.correspondences, [](const Correspondence& c) { return c.projector == 2; });
  }
  const auto calibration = calibrate(measured, "2026-01-01T00-00-00Z");
  ASSERT_FALSE(calibration);
  EXPECT_NE(calibration.error().message().find("'projector 3'"), std::string::npos) << calibration.error().message();
}

TEST(Calibrate, is_deterministic) {
  const Measurements measured = GeneratedRoom(coarse_plan(RoomKind::kPlane)).measurements();
  CalibrateOptions options;
  options.with_wall = false;
  const auto one = calibrate(measured, "2026-01-01T00-00-00Z", options);
  const auto two = calibrate(measured, "2026-01-01T00-00-00Z", options);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->projectors[0].map.sigma_px, two->projectors[0].map.sigma_px);
}

}  // namespace
}  // namespace cyclorama::solve
