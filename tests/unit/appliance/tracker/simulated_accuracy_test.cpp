// SPDX-License-Identifier: Apache-2.0
/// Accuracy of the tracker, which sees only pixels; compared with the truth afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "appliance/tracker/overlay.h"
#include "appliance/tracker/tag_tracking.h"
#include "drivers/simulated/camera/simulated_camera.h"

namespace cyclorama::tracker {
namespace {

struct Score {
  int pictures = 0;
  int found = 0;
  int wrong_side = 0;  ///< Pictures with a yaw error of more than 10°: the mirrored pose.
  double position_mm = 0.0;
  double yaw_deg = 0.0;
  double raw_yaw_deg = 0.0;
};

/// Returns root mean squares over the pictures of `seconds`.
Score score(const simulated::Simulation& simulation, const TrackingSettings& settings, double seconds) {
  const simulated::SimulatedView view(simulation);
  auto detector = tags::TagDetector::create({});
  EXPECT_TRUE(detector.has_value());
  Score result;
  TrackingState state;
  result.pictures = static_cast<int>(seconds * simulation.frames_per_second);
  for (int i = 0; i < result.pictures; ++i) {
    const double shutter_s = i / simulation.frames_per_second;
    const auto found = detector->detect(view.picture(static_cast<std::uint64_t>(i)));
    EXPECT_TRUE(found.has_value());
    const TimePoint at(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1000.0 + shutter_s)));
    const TrackingResult tracked = track(settings, state, *found, simulation.lens, at);
    state = tracked.state;
    if (!tracked.tag) continue;
    ++result.found;
    const auto truth = simulation.path.at(shutter_s + 0.5 * simulation.exposure_s);
    const auto degrees_off = [&](const T_CameraTag& pose) {
      return std::remainder(yaw_rad(pose) - yaw_rad(truth), 2.0 * std::numbers::pi) * 180.0 / std::numbers::pi;
    };
    const double yaw = degrees_off(tracked.tag->T_camera_tag);
    const double raw = degrees_off(tracked.tag->chosen.pose.T_camera_tag);
    result.position_mm += 1e6 * (tracked.tag->T_camera_tag.translation() - truth.translation()).squaredNorm();
    result.yaw_deg += yaw * yaw;
    result.raw_yaw_deg += raw * raw;
    result.wrong_side += std::abs(raw) > 10.0 ? 1 : 0;
  }
  const double count = std::max(1, result.found);
  result.position_mm = std::sqrt(result.position_mm / count);
  result.yaw_deg = std::sqrt(result.yaw_deg / count);
  result.raw_yaw_deg = std::sqrt(result.raw_yaw_deg / count);
  return result;
}

void print(const std::string& what, const Score& s) {
  std::printf("%-24s found %d of %d, position %.2f mm, yaw %.2f deg (unfiltered %.2f), wrong side %d\n", what.c_str(),
              s.found, s.pictures, s.position_mm, s.yaw_deg, s.raw_yaw_deg, s.wrong_side);
}

/// A hand that sways by ±18° and 10 cm around a distance.
simulated::HandPath sway(double distance_m) {
  std::vector<simulated::KeyPose> keys;
  for (int i = 0; i < 4; ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    keys.push_back({1.5 * i, {0.05 * side, 0.02, distance_m}, 0.31 * side, 0.14, 0.02 * side});
  }
  auto path = simulated::HandPath::make(std::move(keys), 6.0);
  EXPECT_TRUE(path.has_value());
  return *std::move(path);
}

struct Place {
  double distance_m;
  double max_position_mm;
  double max_yaw_deg;
};
class Distance : public testing::TestWithParam<Place> {};

TEST_P(Distance, the_pose_of_a_swaying_tag_is_near_the_truth) {
  simulated::Simulation simulation;
  simulation.path = sway(GetParam().distance_m);
  simulation.frames_per_second = 15.0;
  const Score s = score(simulation, {}, 9.0);
  print("sway at " + std::to_string(GetParam().distance_m).substr(0, 3) + " m:", s);
  EXPECT_GE(s.found, s.pictures * 99 / 100);
  EXPECT_LT(s.position_mm, GetParam().max_position_mm);
  EXPECT_LT(s.yaw_deg, GetParam().max_yaw_deg);
}
INSTANTIATE_TEST_SUITE_P(All, Distance,
                         testing::Values(Place{0.6, 5.0, 0.9}, Place{1.0, 5.0, 0.9}, Place{2.0, 6.0, 1.0}));

TEST(SimulatedAccuracy, the_whole_demo_is_tracked) {
  simulated::Simulation simulation;
  simulation.frames_per_second = 10.0;
  const Score s = score(simulation, {}, 28.0);
  print("demo:", s);
  EXPECT_EQ(s.found, s.pictures);
  EXPECT_EQ(s.wrong_side, 0);
  EXPECT_LT(s.position_mm, 4.0);
  EXPECT_LT(s.yaw_deg, 0.5);
  EXPECT_LT(s.raw_yaw_deg, 0.3);
}

TEST(SimulatedAccuracy, a_dim_noisy_and_blurred_picture_is_tracked) {
  simulated::Simulation simulation;
  simulation.frames_per_second = 15.0;
  simulation.noise_grey = 5.0;
  simulation.brightness = 0.5;
  simulation.exposure_s = 0.015;
  simulation.exposure_steps = 8;
  const Score s = score(simulation, {}, 9.0);
  print("dim, noisy, blurred:", s);
  EXPECT_GE(s.found, s.pictures * 97 / 100);
  EXPECT_LT(s.yaw_deg, 1.0);
}

}  // namespace
}  // namespace cyclorama::tracker
