// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/hand_path.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::simulated {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

KeyPose key(double time_s, double x, double yaw_rad = 0.0) { return {time_s, {x, 0.0, 1.0}, yaw_rad, 0.0, 0.0}; }

double x_at(const HandPath& path, double time_s) { return path.at(time_s).translation().x(); }

HandPath path_of(std::vector<KeyPose> keys, std::optional<double> loop_s) {
  auto path = HandPath::make(std::move(keys), loop_s);
  EXPECT_TRUE(path.has_value()) << path.error().message();
  return *std::move(path);
}

TEST(HandPath, passes_through_every_key) {
  const HandPath path = path_of({key(0, 0.0), key(1, 0.5, 1.0), key(3, 0.2, -2.0), key(3.5, 0.9)}, 5.0);
  EXPECT_NEAR(x_at(path, 0), 0.0, 1e-12);
  EXPECT_NEAR(x_at(path, 1), 0.5, 1e-12);
  EXPECT_NEAR(x_at(path, 3), 0.2, 1e-12);
  EXPECT_NEAR(x_at(path, 3.5), 0.9, 1e-12);
  EXPECT_NEAR(path.at(3).rotation().angularDistance(rotation_of(key(0, 0, -2.0))), 0.0, 1e-9);
}

TEST(HandPath, holds_still_between_equal_keys_and_never_overshoots) {
  const HandPath path = path_of({key(0, 0.0), key(1, 0.5), key(2, 0.5), key(3, 0.1)}, std::nullopt);
  for (double t = 0.0; t <= 3.0; t += 0.01) {
    EXPECT_GE(x_at(path, t), -1e-12) << t;
    EXPECT_LE(x_at(path, t), 0.5 + 1e-12) << t;
    if (t >= 1.0 && t <= 2.0) {
      EXPECT_NEAR(x_at(path, t), 0.5, 1e-12) << t;
    }
  }
}

TEST(HandPath, is_smooth_across_the_loop) {
  const HandPath path = HandPath::demo();
  const double step = 1e-3;
  double fastest = 0.0;
  Eigen::Vector3d last_speed = (path.at(step).translation() - path.at(0).translation()) / step;
  for (double t = step; t < 2.0 * path.duration_s(); t += step) {
    const Eigen::Vector3d speed = (path.at(t + step).translation() - path.at(t).translation()) / step;
    EXPECT_LT((speed - last_speed).norm(), 0.01) << "the hand jerks at " << t << " s";
    fastest = std::max(fastest, speed.norm());
    last_speed = speed;
  }
  EXPECT_LT(fastest, 1.0) << "no visitor moves like that";
  EXPECT_GT(fastest, 0.05);
}

TEST(HandPath, repeats_after_its_loop_and_for_times_before_its_start) {
  const HandPath path = HandPath::demo();
  for (double t = 0.0; t < path.duration_s(); t += 0.7) {
    for (const double shift : {-2.0, 1.0, 1000.0}) {
      const auto there = path.at(t + shift * path.duration_s());
      EXPECT_NEAR((there.translation() - path.at(t).translation()).norm(), 0.0, 1e-9);
      EXPECT_NEAR(there.rotation().angularDistance(path.at(t).rotation()), 0.0, 1e-6);
    }
  }
}

TEST(HandPath, keeps_its_ends_unless_it_loops) {
  const HandPath path = path_of({key(1, 0.0), key(2, 0.5)}, std::nullopt);
  EXPECT_EQ(x_at(path, -100), 0.0);
  EXPECT_EQ(x_at(path, 100), 0.5);
  const HandPath lone = path_of({key(3, 0.7)}, std::nullopt);
  EXPECT_EQ(x_at(lone, 0), 0.7);
  EXPECT_EQ(x_at(lone, 9), 0.7);
}

TEST(HandPath, has_a_pose_for_a_time_that_is_not_finite) {
  for (const double t : {kNan, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(HandPath::demo().at(t).translation().allFinite());
  }
}

TEST(HandPath, turns_the_tags_face_to_the_visitors_right) {
  // The visitor faces the camera, so their right is -x; the face looks along -z of the tag.
  const HandPath path = path_of({key(0, 0.0, 0.3)}, std::nullopt);
  const Eigen::Vector3d face = path.at(0).rotation() * -Eigen::Vector3d::UnitZ();
  EXPECT_LT(face.x(), -0.2);
  EXPECT_LT(face.z(), -0.9);
}

TEST(HandPath, refuses_invalid_movements) {
  EXPECT_FALSE(HandPath::make({}, std::nullopt).has_value());
  EXPECT_FALSE(HandPath::make({key(0, kNan)}, std::nullopt).has_value());
  EXPECT_FALSE(HandPath::make({key(kNan, 0)}, std::nullopt).has_value());
  EXPECT_FALSE(HandPath::make({key(1, 0), key(1, 0)}, std::nullopt).has_value());
  EXPECT_FALSE(HandPath::make({key(0, 0), key(2, 0)}, 2.0).has_value());
  EXPECT_FALSE(HandPath::make({key(0, 0)}, kNan).has_value());
}

}  // namespace
}  // namespace cyclorama::simulated
