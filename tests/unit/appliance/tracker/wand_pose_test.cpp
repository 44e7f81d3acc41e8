// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/wand_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>

#include "common/wand/folded_card.h"

namespace cyclorama::tracker {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

const Pinhole kLens{640, 480, 600.0, 320.0, 240.0};
constexpr double kFloorPx = 0.03;

T_CameraTag pose_at(double yaw_deg, double z_m) {
  return {Eigen::AngleAxisd(yaw_deg * 0.017453292519943295, Vector3d::UnitY()) *
              Eigen::AngleAxisd(-0.12, Vector3d::UnitX()),
          {0.03, 0.02, z_m}};
}

/// Returns the tags of `wand` that face the camera, projected by the pose.
std::vector<tags::TagDetection> seen_of(const Wand& wand, const T_CameraTag& pose) {
  std::vector<tags::TagDetection> seen;
  for (const WandTag& tag : wand.tags) {
    const auto face = face_of(tag);
    const Vector3d into = pose.rotation() * (face.rotation() * Vector3d::UnitZ());
    if (into.dot((pose * Point<frame::Tag>{face.translation()}).xyz.normalized()) < 0.2) continue;
    tags::TagDetection detection{tag.id, 0, 80.0, {}};
    for (std::size_t i = 0; i < 4; ++i)
      detection.corners[i] = *kLens.pixel_of((pose * Point<frame::Tag>{tag.corners[i]}).xyz);
    seen.push_back(detection);
  }
  return seen;
}

void shake(double deviation_px, std::mt19937* random, std::vector<tags::TagDetection>* seen) {
  std::normal_distribution<double> normal(0.0, deviation_px);
  for (tags::TagDetection& tag : *seen) {
    for (std::size_t i = 0; i < 4; ++i) {
      tag.corners[i] += Eigen::Vector2d(normal(*random), normal(*random));
      tag.covariance[i] = deviation_px * deviation_px * Eigen::Matrix2d::Identity();
    }
  }
}

Vector6d error_of(const T_CameraTag& measured, const T_CameraTag& truth) {
  const Eigen::AngleAxisd turn(measured.rotation() * truth.rotation().conjugate());
  Vector6d error;
  error << turn.angle() * turn.axis(), measured.translation() - truth.translation();
  return error;
}

TEST(WandPose, is_exact_for_exact_corners) {
  const Wand wand = standard_wand(3);
  for (double yaw = -80.0; yaw <= 80.0; yaw += 10.0) {
    const T_CameraTag truth = pose_at(yaw, 1.4);
    const auto poses = estimate_wand_poses(wand, seen_of(wand, truth), kFloorPx, kLens);
    ASSERT_TRUE(poses.has_value()) << yaw;
    EXPECT_LT(error_of(poses->best.T_camera_tag, truth).norm(), 1e-5) << yaw;
    EXPECT_LT(poses->best.misfit, 1e-3);
  }
}

TEST(WandPose, is_unambiguous_where_a_flat_tag_has_two_poses) {
  const T_CameraTag truth = pose_at(20.0, 1.5);
  std::mt19937 random(4);
  auto flat = seen_of(flat_tag(0, 0.07), truth);
  shake(0.05, &random, &flat);
  EXPECT_TRUE(estimate_wand_poses(flat_tag(0, 0.07), flat, kFloorPx, kLens)->other.has_value());
  auto seen = seen_of(standard_wand(0), truth);
  shake(0.05, &random, &seen);
  const auto poses = estimate_wand_poses(standard_wand(0), seen, kFloorPx, kLens);
  ASSERT_TRUE(poses.has_value());
  EXPECT_FALSE(poses->other.has_value());
}

TEST(WandPose, is_the_tags_own_pose_for_a_flat_tag) {
  std::mt19937 random(5);
  for (int i = 0; i < 100; ++i) {
    auto seen = seen_of(flat_tag(0, 0.12), pose_at(0.6 * i - 30.0, 0.9));
    shake(0.1, &random, &seen);
    const auto alone = estimate_poses(seen[0].corners, 0.12, kLens);
    const auto wand = estimate_wand_poses(flat_tag(0, 0.12), seen, kFloorPx, kLens);
    ASSERT_TRUE(alone && wand);
    // The loss shifts the minimum a little, since outliers have less weight.
    EXPECT_LT(error_of(wand->best.T_camera_tag, alone->best.T_camera_tag).norm(), 0.02) << i;
  }
}

/// The covariance is consistent: errors, in units of it, have mean square 1 per degree of freedom.
TEST(WandPose, has_a_consistent_covariance) {
  const Wand wand = standard_wand(0);
  std::mt19937 random(6);
  for (const double yaw : {0.0, 30.0, 55.0}) {
    const T_CameraTag truth = pose_at(yaw, 1.2);
    double squares = 0.0;
    constexpr int kTimes = 400;
    for (int i = 0; i < kTimes; ++i) {
      auto seen = seen_of(wand, truth);
      shake(0.1, &random, &seen);
      const auto poses = estimate_wand_poses(wand, seen, 1e-3, kLens);
      ASSERT_TRUE(poses.has_value());
      const Vector6d error = error_of(poses->best.T_camera_tag, truth);
      squares += error.dot(poses->best.covariance.ldlt().solve(error)) / 6.0;
    }
    EXPECT_GT(squares / kTimes, 0.7) << yaw;
    EXPECT_LT(squares / kTimes, 1.3) << yaw;
  }
}

TEST(WandPose, is_little_affected_by_corners_under_a_finger) {
  const Wand wand = standard_wand(0);
  const T_CameraTag truth = pose_at(10.0, 1.0);
  std::mt19937 random(7);
  auto seen = seen_of(wand, truth);
  shake(0.05, &random, &seen);
  seen[2].corners[2] += Eigen::Vector2d(-3.0, 2.0);
  const auto poses = estimate_wand_poses(wand, seen, kFloorPx, kLens);
  ASSERT_TRUE(poses.has_value());
  EXPECT_LT(error_of(poses->best.T_camera_tag, truth).head<3>().norm(), 0.01);
}

TEST(WandPose, rejects_a_pose_that_would_show_an_unseen_tag) {
  // Turned far to a side, only the left panel is visible. Its other pose turns the wand to the front, where the middle
  // tag would be visible.
  const Wand wand = standard_wand(0);
  const T_CameraTag truth = pose_at(-62.0, 2.2);
  std::mt19937 random(8);
  int right = 0;
  int right_alone = 0;
  for (int i = 0; i < 100; ++i) {
    auto seen = seen_of(wand, truth);
    std::erase_if(seen, [](const tags::TagDetection& tag) { return tag.id != 0; });
    ASSERT_EQ(seen.size(), 1U);
    shake(0.3, &random, &seen);
    const auto poses = estimate_wand_poses(wand, seen, kFloorPx, kLens);
    const auto is_right = [&](const TagPose& pose) {
      return error_of(pose.T_camera_tag, truth).head<3>().norm() < 0.35;
    };
    right += poses && is_right(poses->best) ? 1 : 0;
    const auto alone = estimate_wand_poses(Wand{"", {wand.tags[0]}}, seen, kFloorPx, kLens);
    right_alone += alone && is_right(alone->best) ? 1 : 0;
  }
  EXPECT_GE(right, right_alone);
  EXPECT_GE(right, 60);
}

TEST(WandPose, is_finite_or_nothing_for_any_corners) {
  const Wand wand = standard_wand(0);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> any(-2000.0, 3000.0);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 0.0};
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    auto seen = seen_of(wand, pose_at(0.0, 1.0));
    for (tags::TagDetection& tag : seen) {
      for (Eigen::Vector2d& corner : tag.corners) {
        if (i % 3 == 0) corner = {any(random), any(random)};
        if (i % 3 == 1) corner += Eigen::Vector2d(0.01 * any(random), 0.0);
      }
    }
    if (i % 5 == 0) seen[static_cast<std::size_t>(i % 3)].corners[1].x() = bad[i % 4];
    if (i % 7 == 0) seen[0].covariance[2] *= bad[i % 4];
    const auto poses = estimate_wand_poses(wand, seen, kFloorPx, kLens);
    if (!poses) continue;
    ++found;
    for (const TagPose* pose : {&poses->best, poses->other ? &*poses->other : &poses->best}) {
      EXPECT_TRUE(pose->T_camera_tag.translation().allFinite());
      EXPECT_TRUE(pose->T_camera_tag.rotation().coeffs().allFinite());
      EXPECT_TRUE(pose->covariance.allFinite());
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(pose->covariance).eigenvalues()[0], -1e-12);
    }
  }
  EXPECT_GT(found, 500);
  EXPECT_FALSE(estimate_wand_poses(wand, {}, kFloorPx, kLens).has_value());
}

TEST(FitPose, refuses_points_that_determine_no_pose) {
  const auto points = [](std::initializer_list<Vector3d> positions) {
    std::vector<SeenPoint> seen;
    for (const Vector3d& position : positions)
      seen.push_back({position, *kLens.pixel_of(position + Vector3d(0, 0, 1)), Eigen::Matrix2d::Identity()});
    return seen;
  };
  const T_CameraTag start(Eigen::Quaterniond::Identity(), {0, 0, 1});
  EXPECT_FALSE(fit_pose(points({}), start, kLens).has_value());
  EXPECT_FALSE(fit_pose(points({{0, 0, 0}, {0.1, 0, 0}}), start, kLens).has_value());
  EXPECT_FALSE(fit_pose(points({{0, 0, 0}, {0.1, 0, 0}, {0.2, 0, 0}, {-0.1, 0, 0}}), start, kLens).has_value());
  EXPECT_FALSE(fit_pose(points({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), start, kLens).has_value());
  EXPECT_TRUE(fit_pose(points({{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0.02}}), start, kLens).has_value());
}

TEST(MixedCovariance, is_large_where_either_pose_may_be_right) {
  TagPose a;
  a.T_camera_tag = pose_at(20.0, 1.0);
  a.covariance = 1e-6 * Matrix6d::Identity();
  TagPose b = a;
  b.T_camera_tag = pose_at(-20.0, 1.0);
  EXPECT_TRUE(mixed_covariance(a, b, 1.0).isApprox(a.covariance));
  const double turned = (mixed_covariance(a, b, 0.5).topLeftCorner<3, 3>().trace());
  EXPECT_NEAR(turned, 0.5 * std::pow(40.0 * 0.017453292519943295, 2), 1e-3);
}

}  // namespace
}  // namespace cyclorama::tracker
