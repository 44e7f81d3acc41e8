// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/pose_solve.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "appliance/healing/estimator/feature_matching.h"

namespace cyclorama::healing {
namespace {

/// Three projectors and three cameras before a cylinder.
calibration::ShowCalibration room() {
  calibration::ShowCalibration made;
  CylinderWall wall;
  wall.radius_m = 4.3;
  wall.arc_rad = 2.2;
  wall.bottom_m = 0.6;
  wall.top_m = 2.6;
  made.wall = wall;
  made.sweet_spot = {{0.0, 1.6, 0.0}};
  for (int i = -1; i <= 1; ++i) {
    const Eigen::Quaterniond ahead(Eigen::AngleAxisd(-0.65 * i, Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    calibration::ShowProjector projector;
    projector.name = "projector " + std::to_string(i + 2);
    projector.lens = {1920, 1080, 2000.0, 2000.0, 960.0, 540.0, -0.03, 0.01, 5e-4, -3e-4};
    projector.T_room_projector = {ahead, Eigen::Vector3d(-0.2 * i, 1.7, 0.4)};
    made.projectors.push_back(projector);
    calibration::ShowCamera camera;
    camera.name = "camera " + std::to_string(i + 2);
    camera.lens = {1600, 1200, 950.0, 950.0, 800.0, 600.0, -0.1, 0.02};
    camera.T_room_camera = {ahead, Eigen::Vector3d(-0.2 * i + 0.15, 1.8, 0.4)};
    made.cameras.push_back(camera);
  }
  return made;
}

/// Returns what the cameras of the `real` room see of `believed`'s projectors' pixels.
std::vector<PatchObservation> observations(const calibration::ShowCalibration& believed,
                                           const calibration::ShowCalibration& real, double noise_px,
                                           double gross = 0.0) {
  std::vector<PatchObservation> made;
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, noise_px);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  for (std::size_t j = 0; j < real.projectors.size(); ++j) {
    for (int k = 0; k < 15 * 9; ++k) {
      const Eigen::Vector2d shown((k % 15 + 0.5) * 128.0, (k / 15 + 0.5) * 120.0);
      const auto wall = calibration::wall_lit_at(real, real.projectors[j], shown);
      if (!wall) continue;
      for (std::size_t c = 0; c < real.cameras.size(); ++c) {
        const calibration::ShowCamera& camera = real.cameras[c];
        const auto seen =
            calibration::pixel_of(camera.lens, (camera.T_room_camera.inverse() * Point<frame::Room>{*wall}).xyz);
        if (!seen || !calibration::contains(camera.lens, *seen) ||
            std::abs(static_cast<int>(c) - static_cast<int>(j)) > 1)
          continue;
        Eigen::Vector2d at = *seen + Eigen::Vector2d(noise(random), noise(random));
        if (chance(random) < gross) at += Eigen::Vector2d(60.0 * chance(random), -50.0 * chance(random));
        const auto one = patch_observation(believed, c, j, shown, at,
                                           std::max(noise_px * noise_px, 1e-6) * Eigen::Matrix2d::Identity(), 0.1);
        if (one) made.push_back(*one);
      }
    }
  }
  return made;
}

std::vector<BodyPrior> tight_priors(const calibration::ShowCalibration& room) {
  BodyPrior prior;
  calibration::PoseStep weights;
  weights << Eigen::Vector3d::Constant(1e8), Eigen::Vector3d::Constant(1e7);
  prior.information = weights.asDiagonal();
  return std::vector<BodyPrior>(room.projectors.size() + room.cameras.size(), prior);
}

calibration::PoseStep bump() {
  calibration::PoseStep step;
  step << 0.004, -0.007, 0.003, 0.01, -0.004, 0.006;
  return step;
}

TEST(ShowCalibration, slopes_and_pixels_are_inverse) {
  const calibration::ShowProjector projector = room().projectors[0];
  for (double u : {0.0, 300.0, 1919.0}) {
    for (double v : {0.0, 700.0, 1080.0}) {
      const auto slope = calibration::slope_at(projector.lens, {u, v});
      ASSERT_TRUE(slope);
      EXPECT_LT((*calibration::pixel_of(projector.lens, slope->homogeneous()) - Eigen::Vector2d(u, v)).norm(), 1e-8);
    }
  }
  EXPECT_FALSE(calibration::slope_at({100, 100, 50.0, 50.0, 50.0, 50.0, -1.0}, {2000.0, 0.0}));
}

TEST(FindMovedBodies, finds_the_displaced_projector_and_its_pose) {
  const calibration::ShowCalibration believed = room();
  calibration::ShowCalibration real = believed;
  real.projectors[1].T_room_projector = calibration::stepped(believed.projectors[1].T_room_projector, bump());
  const auto priors = tight_priors(believed);
  const std::vector<calibration::PoseStep> starts(priors.size(), calibration::PoseStep::Zero());
  const auto movers = find_moved_bodies(believed, observations(believed, real, 0.05, 0.1), {}, priors, starts);
  ASSERT_TRUE(movers) << movers.error().message();
  ASSERT_EQ(movers->bodies, std::vector<BodyIndex>{1});
  const PixelMotion motion = pixel_motion(believed, believed.projectors[1]);
  EXPECT_GT(motion.rms_px(bump()), 10.0);
  EXPECT_LT(motion.rms_px(movers->solution.bodies[1].step - bump()), 0.2);
  EXPECT_EQ(movers->solution.bodies[1].rank, 6);
}

TEST(FindMovedBodies, distinguishes_a_displaced_camera_from_displaced_projectors) {
  const calibration::ShowCalibration believed = room();
  calibration::ShowCalibration real = believed;
  real.cameras[1].T_room_camera = calibration::stepped(believed.cameras[1].T_room_camera, bump());
  const auto priors = tight_priors(believed);
  const std::vector<calibration::PoseStep> starts(priors.size(), calibration::PoseStep::Zero());
  const auto movers = find_moved_bodies(believed, observations(believed, real, 0.05), {}, priors, starts);
  ASSERT_TRUE(movers);
  EXPECT_EQ(movers->bodies, std::vector<BodyIndex>{4});
}

TEST(FindMovedBodies, finds_two_displacements_at_once_and_none_where_nothing_moved) {
  const calibration::ShowCalibration believed = room();
  calibration::ShowCalibration real = believed;
  const auto priors = tight_priors(believed);
  const std::vector<calibration::PoseStep> starts(priors.size(), calibration::PoseStep::Zero());
  EXPECT_TRUE(find_moved_bodies(believed, observations(believed, real, 0.05, 0.1), {}, priors, starts)->bodies.empty());
  real.projectors[0].T_room_projector = calibration::stepped(believed.projectors[0].T_room_projector, bump());
  real.projectors[2].T_room_projector =
      calibration::stepped(believed.projectors[2].T_room_projector, calibration::PoseStep(-bump()));
  auto movers = find_moved_bodies(believed, observations(believed, real, 0.05), {}, priors, starts);
  ASSERT_TRUE(movers);
  std::ranges::sort(movers->bodies);
  EXPECT_EQ(movers->bodies, (std::vector<BodyIndex>{0, 2}));
}

TEST(SolvePoses, covariance_and_rank_show_what_is_determined) {
  const calibration::ShowCalibration believed = room();
  std::vector<BodyPrior> priors = tight_priors(believed);
  priors[0].information = loose_information();
  std::vector<PatchObservation> all = observations(believed, believed, 0.05);
  const auto whole = solve_poses(believed, all, {}, priors);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->bodies[0].rank, 6);
  // Two observations give four numbers.
  std::erase_if(all, [](const PatchObservation& s) { return s.projector == 0; });
  EXPECT_EQ(solve_poses(believed, all, {}, priors)->bodies[0].rank, 0);
  const auto own = observations(believed, believed, 0.05);
  all.insert(all.end(), own.begin(), own.begin() + 2);
  EXPECT_LE(solve_poses(believed, all, {}, priors)->bodies[0].rank, 4);
  EXPECT_FALSE(solve_poses(believed, {}, {}, priors));
}

TEST(Features, determine_a_pose_although_a_third_of_them_are_wrong) {
  const calibration::ShowCalibration believed = room();
  calibration::ShowCalibration real = believed;
  calibration::PoseStep far = bump();
  far *= 8.0;
  real.projectors[1].T_room_projector = calibration::stepped(believed.projectors[1].T_room_projector, far);
  const auto step = find_projector(believed, 1, observations(believed, real, 0.3, 0.33));
  ASSERT_TRUE(step);
  EXPECT_LT(pixel_motion(believed, believed.projectors[1]).rms_px(*step - far), 6.0);
  real = believed;
  real.cameras[2].T_room_camera = calibration::stepped(believed.cameras[2].T_room_camera, far);
  const auto eye = find_camera(believed, 2, observations(believed, real, 0.3, 0.33));
  ASSERT_TRUE(eye);
  EXPECT_LT((*eye - far).head<3>().norm(), 4e-3);
}

}  // namespace
}  // namespace cyclorama::healing
