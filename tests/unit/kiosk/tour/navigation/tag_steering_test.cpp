// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/tag_steering.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace cyclorama::tour {
namespace {

using TagPose = RigidTransform<frame::Camera, frame::Tag>;

/// Returns the pose of a tag held at a position of the ROOM as the visitor sees it, pointing `yaw` to the visitor's
/// right. Built from the room's axes (x to the visitor's right, y up, z towards the visitor), without any formula of
/// the code under test.
TagPose held_at(double right_m, double nearer_to_visitor_m, double yaw_right_rad) {
  // The camera stands at the wall and looks along +z of the room; its x is the room's -x, its y the room's -y.
  Eigen::Matrix3d R_room_camera;
  R_room_camera.col(0) = Eigen::Vector3d(-1, 0, 0);
  R_room_camera.col(1) = Eigen::Vector3d(0, -1, 0);
  R_room_camera.col(2) = Eigen::Vector3d(0, 0, 1);
  // The print points to the wall (-z of the room), turned to the right: (sin, 0, -cos). The tag's z is opposite.
  const Eigen::Vector3d print(std::sin(yaw_right_rad), 0, -std::cos(yaw_right_rad));
  Eigen::Matrix3d R_room_tag;
  R_room_tag.col(2) = -print;
  R_room_tag.col(1) = Eigen::Vector3d(0, -1, 0);
  R_room_tag.col(0) = R_room_tag.col(1).cross(R_room_tag.col(2));
  const Eigen::Vector3d position(right_m, 0, nearer_to_visitor_m);
  return {Eigen::Quaterniond(R_room_camera.transpose() * R_room_tag), R_room_camera.transpose() * position};
}

constexpr TagSteeringSettings kSettings{};

TEST(TagSteering, rests_when_the_tag_is_held_straight_at_the_neutral_position) {
  const TagPose straight = held_at(0, kSettings.neutral_distance_m, 0);
  EXPECT_TRUE(straight.rotation().isApprox(Eigen::Quaterniond::Identity())) << "tag axes equal camera axes";
  EXPECT_TRUE(tag_command(straight, kSettings).is_rest());
}

TEST(TagSteering, turns_the_view_to_the_side_to_which_the_tag_is_turned) {
  EXPECT_NEAR(pointing_yaw(held_at(0, 1, 0.5)), 0.5, 1e-12);
  EXPECT_NEAR(pointing_yaw(held_at(0.3, 2, -0.7)), -0.7, 1e-12);
  EXPECT_GT(tag_command(held_at(0, 1, 0.4), kSettings).turn, 0.0);
  EXPECT_LT(tag_command(held_at(0, 1, -0.4), kSettings).turn, 0.0);
}

TEST(TagSteering, walks_to_the_visitors_side_on_which_the_tag_is_held) {
  const TagPose at_right_hand = held_at(0.2, kSettings.neutral_distance_m, 0);
  EXPECT_LT(at_right_hand.translation().x(), 0.0) << "left of the camera's middle";
  EXPECT_GT(tag_command(at_right_hand, kSettings).right, 0.0);
  EXPECT_LT(tag_command(held_at(-0.2, kSettings.neutral_distance_m, 0), kSettings).right, 0.0);
}

TEST(TagSteering, walks_forward_when_the_tag_is_nearer_to_the_wall_and_back_when_it_is_farther) {
  EXPECT_GT(tag_command(held_at(0, kSettings.neutral_distance_m - 0.3, 0), kSettings).forward, 0.0);
  EXPECT_LT(tag_command(held_at(0, kSettings.neutral_distance_m + 0.3, 0), kSettings).forward, 0.0);
}

TEST(TagSteering, ignores_tilt_and_rotation_in_the_tags_own_plane) {
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond roll(Eigen::AngleAxisd(1.3, Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(pointing_yaw({tilt * roll, {0, 0, 1}}), 0.0, 1e-12);
  EXPECT_NEAR(pointing_yaw({held_at(0, 1, 0.3).rotation() * roll, {0, 0, 1}}), 0.3, 1e-12);
}

TEST(TagSteering, does_not_turn_with_a_tag_that_lies_flat) {
  const Eigen::Quaterniond flat(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  EXPECT_EQ(pointing_yaw({flat, {0, 0, 1}}), 0.0);
}

TEST(GainCurve, is_zero_then_gentle_then_full_and_odd) {
  const GainCurve curve{0.1, 0.5};
  EXPECT_EQ(curve.at(0.1), 0.0);
  EXPECT_EQ(curve.at(0.5), 1.0);
  EXPECT_EQ(curve.at(7.0), 1.0);
  double before = 0.0;
  for (double offset = 0.0; offset < 0.6; offset += 0.001) {
    EXPECT_EQ(curve.at(-offset), -curve.at(offset));
    EXPECT_GE(curve.at(offset), before);
    EXPECT_LT(curve.at(offset) - before, 0.001 * 1.5 / 0.4 + 1e-9) << "never steeper than 1.5 times the straight line";
    before = curve.at(offset);
  }
  EXPECT_EQ(curve.at(std::numeric_limits<double>::quiet_NaN()), 0.0);
  EXPECT_EQ(curve.at(std::numeric_limits<double>::infinity()), 1.0);
}

}  // namespace
}  // namespace cyclorama::tour
