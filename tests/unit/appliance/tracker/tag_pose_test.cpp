// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tag_pose.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/apriltag_pose.h>
}

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cyclorama::tracker {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;
const Pinhole kLens = Pinhole::from_field_of_view(640, 480, 1.0472);
constexpr double kSize = 0.12;

std::optional<Corners> seen(const T_CameraTag& pose) {
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = kLens.pixel_of((pose * Point<frame::Tag>{corners_of_tag(kSize)[i]}).xyz);
    if (!pixel) return std::nullopt;
    corners[i] = *pixel;
  }
  return corners;
}

T_CameraTag random_pose(std::mt19937* random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(3.1 * any(*random), Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(1.2 * any(*random), Eigen::Vector3d::UnitX());
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(1.2 * any(*random), Eigen::Vector3d::UnitY()));
  const double z = 1.3 + any(*random);
  return {tilt * turn, {0.4 * z * any(*random), 0.3 * z * any(*random), z}};
}

bool faces_camera(const T_CameraTag& pose) {
  const Eigen::Vector3d into_tag = pose.rotation() * Eigen::Vector3d::UnitZ();
  return into_tag.dot(pose.translation().normalized()) > 0.15;
}

TEST(EstimatePoses, recovers_the_pose_from_exact_corners) {
  std::mt19937 random(1);
  int tried = 0;
  while (tried < 2000) {
    const T_CameraTag truth = random_pose(&random);
    const auto corners = seen(truth);
    if (!corners || !faces_camera(truth)) continue;
    ++tried;
    const auto poses = estimate_poses(*corners, kSize, kLens);
    ASSERT_TRUE(poses.has_value());
    EXPECT_LT(poses->best.reprojection_px, 1e-4);
    EXPECT_LT((poses->best.T_camera_tag.translation() - truth.translation()).norm(), 1e-4);
    EXPECT_LT(poses->best.T_camera_tag.rotation().angularDistance(truth.rotation()), 1e-3);
  }
}

TEST(EstimatePoses, returns_the_mirrored_pose_of_a_far_tag_as_the_second_one) {
  const T_CameraTag truth(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY())), {0.0, 0.0, 2.0});
  const auto poses = estimate_poses(*seen(truth), kSize, kLens);
  ASSERT_TRUE(poses.has_value());
  ASSERT_TRUE(poses->other.has_value());
  const Eigen::Quaterniond mirrored(Eigen::AngleAxisd(-0.5, Eigen::Vector3d::UnitY()));
  EXPECT_LT(poses->other->T_camera_tag.rotation().angularDistance(mirrored), 0.1);
  EXPECT_GT(poses->other->reprojection_px, 0.05);
  EXPECT_LT(poses->other->reprojection_px, 1.0);
}

/// Compares with another implementation of another error measure, which agrees where the corners are unambiguous.
TEST(EstimatePoses, agrees_with_libapriltag) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.05);
  int agreed = 0;
  for (int tried = 0; tried < 300;) {
    const T_CameraTag truth = random_pose(&random);
    auto corners = seen(truth);
    if (!corners || !faces_camera(truth) || truth.translation().z() > 0.8) continue;
    ++tried;
    for (Eigen::Vector2d& corner : *corners) corner += Eigen::Vector2d(noise(random), noise(random));
    const auto ours = estimate_poses(*corners, kSize, kLens);
    ASSERT_TRUE(ours.has_value());

    apriltag_detection_t detection{};
    for (std::size_t i = 0; i < 4; ++i) {
      detection.p[i][0] = (*corners)[3 - i].x();
      detection.p[i][1] = (*corners)[3 - i].y();
    }
    // It starts at a homography from the corners (-1, -1) to (1, 1), which the true pose gives.
    const Eigen::Matrix3d r = truth.rotation().toRotationMatrix();
    const Eigen::Vector3d t = truth.translation() / (0.5 * kSize);
    auto* const homography = static_cast<matd_t*>(std::calloc(1, sizeof(matd_t) + 9 * sizeof(double)));
    homography->nrows = homography->ncols = 3;
    for (int row = 0; row < 3; ++row) {
      const double centre = row == 0 ? kLens.centre_u_px : kLens.centre_v_px;
      const Eigen::RowVector3d line(r(row, 0), r(row, 1), t[row]);
      const Eigen::RowVector3d depth(r(2, 0), r(2, 1), t[2]);
      const Eigen::RowVector3d value = row == 2 ? depth : Eigen::RowVector3d(kLens.focal_px * line + centre * depth);
      for (int column = 0; column < 3; ++column) homography->data[3 * row + column] = value[column] / t[2];
    }
    detection.H = homography;
    apriltag_detection_info_t info{&detection,       kSize, kLens.focal_px, kLens.focal_px, kLens.centre_u_px,
                                   kLens.centre_v_px};
    apriltag_pose_t theirs{};
    estimate_tag_pose(&info, &theirs);
    const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(theirs.R->data);
    const Eigen::Vector3d translation = Eigen::Map<const Eigen::Vector3d>(theirs.t->data);
    std::free(theirs.R);
    std::free(theirs.t);
    std::free(homography);
    const bool same = ours->best.T_camera_tag.rotation().angularDistance(Eigen::Quaterniond(rotation)) < 0.05 &&
                      (ours->best.T_camera_tag.translation() - translation).norm() < 0.01;
    agreed += same ? 1 : 0;
  }
  EXPECT_GE(agreed, 290);
}

TEST(EstimatePoses, returns_nothing_for_degenerate_corners) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const Corners square{Eigen::Vector2d(300, 200), {340, 200}, {340, 240}, {300, 240}};
  ASSERT_TRUE(estimate_poses(square, kSize, kLens).has_value());
  for (const double bad : {nan, inf, -inf}) {
    Corners corners = square;
    corners[2].x() = bad;
    EXPECT_FALSE(estimate_poses(corners, kSize, kLens).has_value());
  }
  const Eigen::Vector2d point(100, 100);
  EXPECT_FALSE(estimate_poses({point, point, point, point}, kSize, kLens).has_value());
  EXPECT_FALSE(estimate_poses({Eigen::Vector2d(0, 0), {1, 1}, {2, 2}, {3, 3}}, kSize, kLens).has_value());
  EXPECT_FALSE(estimate_poses({square[3], square[2], square[1], square[0]}, kSize, kLens).has_value());  // From behind.
  EXPECT_FALSE(estimate_poses({square[0], square[2], square[1], square[3]}, kSize, kLens).has_value());  // Crossed.
  EXPECT_FALSE(estimate_poses({square[0], square[1], {310, 210}, square[3]}, kSize, kLens).has_value());  // Dented.
}

TEST(EstimatePoses, returns_finite_numbers_or_nothing_for_any_quadrangle) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponent(-3.0, 5.0);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int answered = 0;
  for (int i = 0; i < 20000; ++i) {
    const double scale = std::pow(10.0, exponent(random));
    Corners corners;
    for (Eigen::Vector2d& corner : corners) corner = {320 + scale * any(random), 240 + scale * any(random)};
    const auto poses = estimate_poses(corners, kSize, kLens);
    if (!poses) continue;
    ++answered;
    for (const TagPose& pose : {poses->best, poses->other.value_or(poses->best)}) {
      EXPECT_TRUE(pose.T_camera_tag.translation().allFinite());
      EXPECT_TRUE(pose.T_camera_tag.rotation().coeffs().allFinite());
      EXPECT_TRUE(std::isfinite(pose.reprojection_px));
      EXPECT_GT(pose.T_camera_tag.translation().z(), 0.0);
    }
    EXPECT_LE(poses->best.reprojection_px, poses->other.value_or(poses->best).reprojection_px);
  }
  EXPECT_GT(answered, 500);
}

}  // namespace
}  // namespace cyclorama::tracker
