// SPDX-License-Identifier: Apache-2.0
// Tests of a realignment's solvers in rooms with exact formulas.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "appliance/photometry/light_file.h"
#include "appliance/photometry/reblend.h"
#include "appliance/scan/realign/camera_pose.h"
#include "appliance/scan/realign/projector_displacement.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegree = 3.14159265358979 / 180.0;

/// A cylinder of 4 m about the y axis.
double cylinder(const Eigen::Vector3d& d) { return std::hypot(d.x(), d.z()) / 4.0; }
/// A plane, 3 m ahead.
double plane(const Eigen::Vector3d& d) { return -d.z() / 3.0; }

TEST(SeenEnd, is_the_intersection_of_the_line_of_sight_with_the_wall) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d centre(1.5 * any(random), any(random), 1.5 * any(random));
    const Eigen::Vector3d along(any(random), 0.3 * any(random), any(random) - 1.2);
    for (const auto& wall : {InverseDepthAt(cylinder), InverseDepthAt(plane)}) {
      const auto d = wall_direction_from(centre, along, wall);
      ASSERT_TRUE(d.has_value());
      const Eigen::Vector3d position = *d / wall(*d);
      // The point is on the line, and in front.
      EXPECT_LT((position - centre).cross(along).norm() / along.norm(), 1e-8);
      EXPECT_GT((position - centre).dot(along), 0.0);
    }
  }
}

TEST(SeenEnd, is_empty_where_there_is_no_wall) {
  EXPECT_FALSE(wall_direction_from({0, 0, 0}, {0, 0, 1}, plane).has_value()) << "away from it";
  EXPECT_FALSE(wall_direction_from({0, 0, -3.5}, {0, 0, -1}, plane).has_value()) << "behind it";
  EXPECT_FALSE(wall_direction_from({0, 0, 0}, {0, 0, 0}, plane).has_value());
  EXPECT_FALSE(wall_direction_from({0, std::nan(""), 0}, {0, 0, -1}, plane).has_value());
}

std::vector<ReferenceObservation> observations_from(const LocatedCamera& camera, double noise_rad) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, noise_rad);
  std::vector<ReferenceObservation> observations;
  for (int y = -8; y <= 8; ++y) {
    for (int x = -20; x <= 20; ++x) {
      const Eigen::Vector3d d = Eigen::Vector3d(std::sin(x * 0.03), y * 0.03, -std::cos(x * 0.03)).normalized();
      const Eigen::Vector3d seen = (camera.R_camera_eye * (d - cylinder(d) * camera.centre_m)).normalized();
      const Eigen::Vector3d ray = (seen + Eigen::Vector3d(noise(random), noise(random), 0.0)).normalized();
      observations.push_back({ray, d, cylinder(d), noise_rad, (x + 3 * y) % 5 == 0});
    }
  }
  return observations;
}

TEST(LocateCamera, finds_the_rotation_and_reports_a_displaced_centre) {
  calibration::CalibratedTurntable turntable;
  turntable.pitch_rad = 0.05;
  turntable.roll_rad = -0.01;
  turntable.offset_m = {0.006, -0.004};
  const LocatedCamera planned = planned_camera(turntable, 0.4);
  EXPECT_LT((planned.R_camera_eye * planned.R_camera_eye.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  for (const double away_m : {0.0, 0.025}) {
    LocatedCamera true_camera = planned;
    true_camera.R_camera_eye =
        Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix() * planned.R_camera_eye;
    true_camera.centre_m += away_m * Eigen::Vector3d(0.6, 0.0, 0.8);
    const auto found = locate_camera(planned, observations_from(true_camera, 5e-5));
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->is_elsewhere, away_m > 0.0);
    EXPECT_LT((found->centre_m - true_camera.centre_m).norm(), 1e-3);
    EXPECT_LT((found->R_camera_eye - true_camera.R_camera_eye).norm(), 3e-4);
    EXPECT_LT(found->heldout_rad, 1e-4);
  }
}

TEST(LocateCamera, is_not_misled_by_a_tenth_of_moved_points) {
  const LocatedCamera planned = planned_camera({}, 0.0);
  auto observations = observations_from(planned, 5e-5);
  for (std::size_t i = 0; i < observations.size(); i += 10)
    observations[i].ray = (observations[i].ray + Eigen::Vector3d(0.02, 0.01, 0.0)).normalized();
  const auto found = locate_camera(planned, observations);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((found->R_camera_eye - planned.R_camera_eye).norm(), 3e-5);
}

TEST(LocateCamera, refuses_too_few_reference_points) {
  const LocatedCamera planned = planned_camera({}, 0.0);
  const auto observations = observations_from(planned, 5e-5);
  EXPECT_FALSE(locate_camera(planned, {observations.data(), 20}).has_value());
}

calibration::FittedProjector projector_at(const Eigen::Vector3d& position, const Eigen::Quaterniond& turn) {
  calibration::FittedProjector projector;
  projector.lens = calibration::MeasuredLens::from_focal(1280, 800, 1500.0);
  projector.lens.values[calibration::MeasuredLens::kK1] = -0.03;
  // The projector looks along -z with its x to the right.
  const Eigen::Quaterniond ahead(Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()));
  projector.T_eye_projector = {turn * ahead, position};
  return projector;
}

std::vector<solve::MapSample> seen_of(const calibration::FittedProjector& projector, const InverseDepthAt& wall,
                                      double noise_px) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, noise_px);
  const calibration::BrownLens lens = *projector.lens.brown();
  std::vector<solve::MapSample> samples;
  for (int y = 8; y < 800; y += 16) {
    for (int x = 8; x < 1280; x += 16) {
      const auto d = drawn_direction(projector, lens, {x, y}, wall);
      if (d) samples.push_back({Eigen::Vector2d(x + noise(random), y + noise(random)), *d, noise_px});
    }
  }
  return samples;
}

class FindDisplacement : public ::testing::Test {
 protected:
  FindDisplacement()
      : before_(projector_at({0.3, 0.8, 0.5}, Eigen::Quaterniond::Identity())),
        map_(*solve::fit_measured_map(1280, 800, seen_of(before_, cylinder, 0.05))) {}
  calibration::FittedProjector before_;
  calibration::MeasuredMap map_;
};

TEST_F(FindDisplacement, finds_small_and_large_displacements) {
  for (const auto& [degrees, metres] : {std::pair(0.05, 0.001), {0.5, 0.02}, {5.0, 0.1}}) {
    calibration::FittedProjector now = before_;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * kDegree, Eigen::Vector3d(0.3, 0.9, 0.2).normalized()));
    now.T_eye_projector = {before_.T_eye_projector.rotation() * turn,
                           before_.T_eye_projector.translation() + metres * Eigen::Vector3d(0.6, 0.64, 0.48)};
    const auto found = find_displacement(before_, map_, seen_of(now, cylinder, 0.1), cylinder);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->verdict, DisplacementVerdict::kDisplaced);
    EXPECT_NEAR(found->turned_rad, degrees * kDegree, 0.02 * kDegree);
    EXPECT_NEAR(found->moved_m, metres, 0.002);
    EXPECT_LT(found->after_px, 0.2);
    EXPECT_GT(found->projector.pose_covariance.diagonal().minCoeff(), 0.0);
  }
}

TEST_F(FindDisplacement, distinguishes_a_turned_lens_from_a_displacement) {
  calibration::FittedProjector now = before_;
  now.lens.values[calibration::MeasuredLens::kFocal] *= 1.1;
  const auto found = find_displacement(before_, map_, seen_of(now, cylinder, 0.1), cylinder);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->verdict, DisplacementVerdict::kLensTurned);
  EXPECT_NEAR(found->zoom, 1.1, 0.02);
}

TEST_F(FindDisplacement, refuses_measurements_of_another_wall) {
  const auto dented = [](const Eigen::Vector3d& d) { return cylinder(d) * (1.0 + 0.05 * std::sin(12.0 * d.x())); };
  const auto found = find_displacement(before_, map_, seen_of(before_, dented, 0.1), cylinder);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->verdict, DisplacementVerdict::kUnexplained);
}

photometry::SavedLight some_light() {
  photometry::SavedLight light;
  for (const char* name : {"left", "right"}) {
    light.names.emplace_back(name);
    photometry::ProjectorLighting& one = light.lighting.projectors.emplace_back();
    one.log_white = {1280, 800, 2, 1, {}, -1.0, 1.0};
    for (int i = 0; i < 5 * 4; ++i) one.log_white.coefficients.push_back(0.02 * i - 0.3);
    one.black_level = {0.001, 0.002, 0.0015};
  }
  light.lighting.ambient(1, 3) = 0.01;
  return light;
}

TEST(LightFile, survives_a_round_trip) {
  const std::string text = photometry::light_json(some_light());
  const auto back = photometry::parse_light(text, "light.json");
  ASSERT_TRUE(back.has_value()) << back.error().message();
  EXPECT_EQ(photometry::light_json(*back), text);
}

TEST(LightFile, names_the_position_of_a_mistake) {
  std::string text = photometry::light_json(some_light());
  text.replace(text.find("\"left\""), 6, "\"right\"");
  const auto twice = photometry::parse_light(text, "light.json");
  ASSERT_FALSE(twice.has_value());
  EXPECT_EQ(twice.error().message(), "light.json: /projectors/1/name: is another projector's name; give each its own");
  EXPECT_FALSE(photometry::parse_light("{", "light.json").has_value());
}

TEST(MoveLight, falls_off_with_the_squared_distance_to_the_wall) {
  // At twice the distance from a plane, a quarter of the light remains.
  const auto map_from = [](double z) {
    return *solve::fit_measured_map(1280, 800,
                                    seen_of(projector_at({0, 0, z}, Eigen::Quaterniond::Identity()), plane, 0.05));
  };
  photometry::ProjectorLighting light = some_light().lighting.projectors[0];
  const double before = light.log_white.at({640, 400});
  photometry::move_light(map_from(-1.0), map_from(1.0), plane, &light);
  EXPECT_NEAR(light.log_white.at({640, 400}) - before, std::log(0.25), 0.02);
}

TEST(Reblended, refuses_parts_of_different_calibrations) {
  EXPECT_FALSE(photometry::reblended({}, {}, {}).has_value());
  const std::vector<calibration::CalibratedColour> colours(2);
  EXPECT_FALSE(photometry::reblended(std::vector<photometry::PhotometricProjector>(2), some_light().lighting, colours)
                   .has_value());
}

}  // namespace
}  // namespace cyclorama::scan
