// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/body_steering.h"

#include <gtest/gtest.h>

#include <limits>

#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using Pose = RigidTransform<frame::Camera, frame::Tag>;

/// Returns a pose built from the positions of head and hips in the ROOM as the visitor sees it (x to the visitor's
/// right, y up), without any formula of the code under test.
Pose standing_at(double right_m, double distance_m, double head_to_the_right_m) {
  const Eigen::Vector3d upwards = Eigen::Vector3d(head_to_the_right_m, 0.8, 0.0).normalized();
  // The camera's x is the room's -x, its y the room's -y, and the body's y is downwards.
  const Eigen::Vector3d down_camera(upwards.x(), upwards.y(), 0.0);
  Eigen::Matrix3d rotation;
  rotation.col(1) = down_camera;
  rotation.col(2) = Eigen::Vector3d::UnitZ();
  rotation.col(0) = rotation.col(1).cross(rotation.col(2));
  return {Eigen::Quaterniond(rotation), {-right_m, 0.0, distance_m}};
}

TEST(BodySteering, rests_at_the_mark_and_ignores_fidgeting) {
  EXPECT_TRUE(body_command(standing_at(0, 2.0, 0), {}).is_rest());
  EXPECT_TRUE(body_command(standing_at(0.1, 2.1, 0.05), {}).is_rest());
}

TEST(BodySteering, turns_by_leaning_slides_by_stepping_aside_and_walks_by_stepping_forward) {
  EXPECT_GT(body_command(standing_at(0, 2.0, 0.2), {}).turn, 0.3);
  EXPECT_LT(body_command(standing_at(0, 2.0, -0.2), {}).turn, -0.3);
  EXPECT_GT(body_command(standing_at(0.35, 2.0, 0), {}).right, 0.3);
  EXPECT_LT(body_command(standing_at(-0.35, 2.0, 0), {}).right, -0.3);
  EXPECT_GT(body_command(standing_at(0, 1.6, 0), {}).forward, 0.3);
  EXPECT_LT(body_command(standing_at(0, 2.4, 0), {}).forward, -0.3);
  EXPECT_EQ(body_command(standing_at(0, 1.6, 0), {}).turn, 0.0);
}

TEST(BodySteering, stays_within_bounds_for_any_pose_of_the_body) {
  for (const double far : {-1e9, -3.0, 3.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    const SteeringCommand command = body_command(Pose(Eigen::Quaterniond::Identity(), {far, far, far}), {});
    EXPECT_LE(std::hypot(command.forward, command.right), 1.0 + 1e-12);
    EXPECT_LE(std::abs(command.turn), 1.0);
  }
}

PoseSeen seen_by(std::uint64_t tracker, std::uint64_t sequence, bool body, const Pose& pose) {
  PoseSeen seen{tracker, sequence, static_cast<std::int64_t>(sequence), true, {}, {}, body};
  for (int i = 0; i < 3; ++i) seen.position_m[static_cast<std::size_t>(i)] = pose.translation()[i];
  const Eigen::Quaterniond& q = pose.rotation();
  seen.rotation = {q.w(), q.x(), q.y(), q.z()};
  return seen;
}

TEST(BodySteering, gives_control_to_a_wand_and_never_takes_it_from_one) {
  const NavigationSettings settings;
  TimePoint now(100s);
  VisitWalk walk = after({}, SceneOpened{"plain", {}}, now, settings);
  const Pose leaning = standing_at(0, 2.0, 0.3);
  const Pose wand(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5});  // Near the camera: forward.
  walk = after(walk, seen_by(1, 1, true, leaning), now += 30ms, settings);
  EXPECT_GT(walk.navigation.tag_command.turn, 0.0);
  for (std::uint64_t i = 2; i < 40; ++i) {
    walk = after(walk, seen_by(2, i, false, wand), now += 15ms, settings);
    walk = after(walk, seen_by(1, i, true, leaning), now += 15ms, settings);
  }
  EXPECT_GT(walk.navigation.tag_command.forward, 0.9);
  EXPECT_LT(walk.navigation.tag_command.turn, 0.01);
}

}  // namespace
}  // namespace cyclorama::tour
