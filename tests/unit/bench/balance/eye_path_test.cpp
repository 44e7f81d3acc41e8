// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/eye_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cyclorama::balance {
namespace {

scene::SceneInfo scene() {
  scene::SceneInfo info;
  info.start_eye = {0.0, 1.6, 2.0};
  info.stops = {{"left", {-1.0, 1.6, 2.0}, -0.5}, {"back", {-1.0, 1.6, 1.0}, std::numbers::pi}};
  return info;
}

TEST(EyePath, orbits_at_one_distance_and_looks_at_the_middle) {
  const Eigen::AlignedBox3d relic(Eigen::Vector3d(-0.5, 0.0, -0.5), Eigen::Vector3d(0.5, 2.0, 0.5));
  const auto path = orbit(scene(), relic, {.frames = 120});
  ASSERT_EQ(path.size(), 120u);
  EXPECT_EQ(path.front().eye, scene().start_eye);
  for (const EyePose& pose : path) {
    EXPECT_NEAR(std::hypot(pose.eye.x(), pose.eye.z()), 2.0, 1e-9);
    EXPECT_DOUBLE_EQ(pose.eye.y(), 1.6);
    const Eigen::Vector3d ahead(std::sin(pose.heading_rad), 0.0, -std::cos(pose.heading_rad));
    EXPECT_NEAR((pose.eye + 2.0 * ahead).head<3>().cwiseProduct(Eigen::Vector3d(1, 0, 1)).norm(), 0.0, 1e-9);
  }
  EXPECT_NEAR(path[60].eye.z(), -2.0, 1e-3);  // Half an orbit.
}

TEST(EyePath, stays_inside_a_hall) {
  const Eigen::AlignedBox3d hall(Eigen::Vector3d(-5.0, 0.0, -3.0), Eigen::Vector3d(5.0, 4.0, 3.0));
  for (const EyePose& pose : orbit(scene(), hall, {.frames = 40, .step_rad = 0.2})) {
    EXPECT_NEAR((pose.eye - Eigen::Vector3d(0.0, 1.6, 0.5)).norm(), 1.5, 1e-9);
  }
}

TEST(EyePath, walks_to_every_stop_in_small_steps) {
  const EyePathOptions options{.frames = 300};
  const auto path = walk(scene(), options);
  ASSERT_EQ(path.size(), 300u);
  std::size_t reached = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_LE((path[i].eye - path[i - 1].eye).norm(), options.step_m + 1e-9);
    EXPECT_LE(std::abs(path[i].heading_rad - path[i - 1].heading_rad), options.step_rad + 1e-9);
    if (reached < 2 && path[i].eye == scene().stops[reached].eye) ++reached;
  }
  EXPECT_EQ(reached, 2u);
}

TEST(EyePath, stands_still_without_stops) {
  scene::SceneInfo info = scene();
  info.stops.clear();
  for (const EyePose& pose : walk(info, {.frames = 5})) EXPECT_EQ(pose.eye, info.start_eye);
}

}  // namespace
}  // namespace cyclorama::balance
