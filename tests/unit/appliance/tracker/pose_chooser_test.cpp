// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/pose_chooser.h"

#include <gtest/gtest.h>

#include <random>

namespace cyclorama::tracker {
namespace {

using std::chrono::milliseconds;

const TimePoint kStart(std::chrono::seconds(1000));

TagPose pose(double yaw_rad, double error_px) {
  // The four corners are known to 0.15 px.
  return {{Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY())), {0, 0, 2}},
          error_px,
          4.0 * error_px * error_px / (0.15 * 0.15),
          Matrix6d::Zero()};
}

/// Orders them like estimate_poses().
TagPoses poses(const TagPose& a, const TagPose& b) {
  return a.reprojection_px <= b.reprojection_px ? TagPoses{a, b} : TagPoses{b, a};
}

bool is(const ChosenPose& chosen, double yaw_rad) {
  return chosen.pose.T_camera_tag.rotation().angularDistance(pose(yaw_rad, 0).T_camera_tag.rotation()) < 0.05;
}

TEST(PoseChooser, takes_the_better_pose_in_the_first_picture) {
  const auto chosen = choose({}, std::nullopt, poses(pose(0.3, 0.1), pose(-0.3, 0.4)), kStart);
  EXPECT_TRUE(is(chosen, 0.3));
  EXPECT_GT(chosen.probability, 0.9);
}

TEST(PoseChooser, takes_the_only_pose_whatever_it_believed) {
  const auto before = choose({}, std::nullopt, poses(pose(0.3, 0.1), pose(-0.3, 0.9)), kStart);
  const auto chosen = choose({}, before.state, {pose(-0.2, 0.1), std::nullopt}, kStart + milliseconds(33));
  EXPECT_TRUE(is(chosen, -0.2));
  EXPECT_EQ(chosen.probability, 1.0);
}

TEST(PoseChooser, is_not_changed_by_one_picture_that_prefers_the_wrong_pose) {
  std::optional<Hypotheses> state;
  for (int i = 0; i < 10; ++i) {
    state = choose({}, state, poses(pose(0.3, 0.1), pose(-0.3, 0.2)), kStart + milliseconds(33) * i).state;
  }
  const auto chosen = choose({}, state, poses(pose(0.3, 0.25), pose(-0.3, 0.1)), kStart + milliseconds(330));
  EXPECT_TRUE(is(chosen, 0.3));
}

TEST(PoseChooser, drops_a_wrong_belief_within_half_a_second) {
  std::optional<Hypotheses> state;
  for (int i = 0; i < 30; ++i) {
    state = choose({}, state, poses(pose(-0.3, 0.05), pose(0.3, 0.9)), kStart + milliseconds(33) * i).state;
  }
  int needed = 0;
  for (; needed < 30; ++needed) {
    const auto chosen = choose({}, state, poses(pose(0.3, 0.05), pose(-0.3, 0.5)),
                               kStart + milliseconds(1000) + milliseconds(33) * needed);
    if (is(chosen, 0.3)) break;
    state = chosen.state;
  }
  EXPECT_LE(needed, 15);
}

TEST(PoseChooser, is_right_far_more_often_than_single_pictures) {
  // Errors like those of a small tag: the right pose is better in most pictures, but by less than the noise.
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.06);
  std::optional<Hypotheses> state;
  int wrong_alone = 0;
  int wrong_over_time = 0;
  constexpr int kPictures = 3000;
  for (int i = 0; i < kPictures; ++i) {
    const TagPoses measured =
        poses(pose(0.3, std::abs(0.14 + noise(random))), pose(-0.3, std::abs(0.22 + noise(random))));
    wrong_alone += measured.best.T_camera_tag.rotation().y() < 0.0 ? 1 : 0;
    const auto chosen = choose({}, state, measured, kStart + milliseconds(33) * i);
    wrong_over_time += is(chosen, 0.3) ? 0 : 1;
    state = chosen.state;
  }
  EXPECT_GT(wrong_alone, kPictures / 10);
  EXPECT_LT(wrong_over_time, kPictures / 50);
}

TEST(PoseChooser, follows_both_poses_while_the_hand_turns) {
  std::optional<Hypotheses> state;
  for (int i = 0; i < 60; ++i) {
    const double yaw = 0.2 + 0.008 * i;
    // From the tenth picture on, the wrong pose is a little better, but the evidence was gathered before.
    const bool early = i < 10;
    const auto chosen = choose({}, state, poses(pose(yaw, early ? 0.05 : 0.10), pose(-yaw, early ? 0.6 : 0.099)),
                               kStart + milliseconds(33) * i);
    EXPECT_TRUE(is(chosen, yaw)) << i;
    state = chosen.state;
  }
}

TEST(PoseChooser, forgets_after_a_gap_and_survives_any_time_stamp) {
  const auto before = choose({}, std::nullopt, poses(pose(0.3, 0.01), pose(-0.3, 0.9)), kStart);
  for (const TimePoint at : {kStart + milliseconds(600), kStart - milliseconds(600), TimePoint::max(), TimePoint()}) {
    EXPECT_TRUE(is(choose({}, before.state, poses(pose(0.3, 0.11), pose(-0.3, 0.1)), at), -0.3));
  }
  for (const TimePoint at : {kStart, kStart - milliseconds(10)}) {
    EXPECT_TRUE(is(choose({}, before.state, poses(pose(0.3, 0.11), pose(-0.3, 0.1)), at), 0.3));
  }
}

}  // namespace
}  // namespace cyclorama::tracker
