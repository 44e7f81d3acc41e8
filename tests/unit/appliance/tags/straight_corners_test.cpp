// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/straight_corners.h"

#include <gtest/gtest.h>

#include "appliance/tracker/tag_pose.h"

namespace cyclorama::tags {
namespace {

const Pinhole kStraight{640, 480, 500.0, 325.0, 236.0, 1.0};

calibration::BrownLens bent() {
  const auto lens = calibration::BrownLens::from({640, 480, 500.0, 500.0, 325.0, 236.0, -0.2, 0.06, 1e-3, -5e-4, 0.0});
  CHECK(lens.has_value());
  return *lens;
}

TagDetection seen_at(const Eigen::Vector3d& middle, const calibration::BrownLens& lens) {
  TagDetection tag;
  const auto corners = tracker::corners_of_tag(0.1);
  for (std::size_t i = 0; i < 4; ++i) tag.corners[i] = *lens.pixel_of(middle + corners[i]);
  return tag;
}

TEST(StraightCorners, are_the_images_in_a_lens_without_distortion) {
  const calibration::BrownLens lens = bent();
  const Eigen::Vector3d middle(0.3, -0.2, 0.9);
  const auto straight = straightened({seen_at(middle, lens)}, lens, kStraight);
  ASSERT_EQ(straight.size(), 1U);
  const auto corners = tracker::corners_of_tag(0.1);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LE((straight[0].corners[i] - *kStraight.pixel_of(middle + corners[i])).norm(), 1e-6);
  }
  // The resulting pose is the true one; with the distorted corners it has an error of a centimetre.
  const auto pose = tracker::estimate_poses(straight[0].corners, 0.1, kStraight);
  ASSERT_TRUE(pose);
  EXPECT_LE((pose->best.T_camera_tag.translation() - middle).norm(), 1e-4);
  const auto astray = tracker::estimate_poses(seen_at(middle, lens).corners, 0.1, kStraight);
  EXPECT_GT((astray->best.T_camera_tag.translation() - middle).norm(), 5e-3);
}

TEST(StraightCorners, propagate_the_covariance_as_differences_do) {
  const calibration::BrownLens lens = bent();
  TagDetection tag = seen_at({0.3, -0.2, 0.9}, lens);
  tag.covariance[2] << 0.02, 0.005, 0.005, 0.01;
  const auto straight = straightened({tag}, lens, kStraight);
  Eigen::Matrix2d moves;
  for (int axis = 0; axis < 2; ++axis) {
    TagDetection moved = tag;
    moved.corners[2] += 1e-4 * Eigen::Vector2d::Unit(axis);
    moves.col(axis) = (straightened({moved}, lens, kStraight)[0].corners[2] - straight[0].corners[2]) / 1e-4;
  }
  EXPECT_LE((straight[0].covariance[2] - moves * tag.covariance[2] * moves.transpose()).norm(), 1e-5);
}

TEST(StraightCorners, leave_out_a_tag_beyond_the_fold) {
  const auto lens = calibration::BrownLens::from({640, 480, 300.0, 300.0, 320.0, 240.0, -0.5, 0.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(lens);
  TagDetection tag = seen_at({0.0, 0.0, 0.9}, *lens);
  EXPECT_EQ(straightened({tag}, *lens, kStraight).size(), 1U);
  tag.corners[1] = {639.0, 1.0};
  EXPECT_TRUE(straightened({tag}, *lens, kStraight).empty());
}

}  // namespace
}  // namespace cyclorama::tags
