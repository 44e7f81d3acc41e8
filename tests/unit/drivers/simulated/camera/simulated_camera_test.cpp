// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/simulated_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/doubles/fake_clock.h"

namespace cyclorama::simulated {
namespace {

using std::chrono::milliseconds;

HandPath still_at(const Eigen::Vector3d& position_m) {
  auto path = HandPath::make({KeyPose{0.0, position_m, 0.0, 0.0, 0.0}}, std::nullopt);
  EXPECT_TRUE(path.has_value());
  return *std::move(path);
}

Simulation plain() {
  Simulation simulation;
  simulation.backdrop = Backdrop::kPlain;
  simulation.noise_grey = 0.0;
  simulation.path = still_at({0.0, 0.0, 0.8});
  simulation.wand = flat_tag(0, 0.12);
  return simulation;
}

TEST(SimulatedView, is_the_same_for_the_same_number_and_differs_for_the_next) {
  const SimulatedView one{Simulation{}};
  const SimulatedView two{Simulation{}};
  EXPECT_EQ(one.picture(17), two.picture(17));
  EXPECT_NE(one.picture(17), one.picture(18));
}

TEST(SimulatedView, adds_noise_of_the_requested_deviation) {
  Simulation simulation = plain();
  simulation.path = still_at({0.0, 0.0, -1.0});  // Behind the camera, so that only the backdrop is visible.
  simulation.noise_grey = 4.0;
  const GreyImage picture = SimulatedView(simulation).picture(5);
  double sum = 0.0;
  double squares = 0.0;
  for (const std::uint8_t grey : picture.data()) {
    sum += grey;
    squares += (grey - 90.0) * (grey - 90.0);
  }
  const auto count = static_cast<double>(picture.data().size());
  EXPECT_NEAR(sum / count, 90.0, 0.1);
  EXPECT_NEAR(std::sqrt(squares / count), 4.0, 0.1);
}

TEST(SimulatedView, places_an_edge_to_a_hundredth_of_a_pixel) {
  // The tag's left edge is upright in the picture: white paper outside, ink inside. Its position in a row follows from
  // the mean of the row's pixels around it.
  for (double shift_px = 0.0; shift_px < 1.0; shift_px += 0.07) {
    Simulation simulation = plain();
    const double z = 0.8;
    simulation.path = still_at({shift_px * z / simulation.lens.focal_px, 0.0, z});
    const GreyImage picture = SimulatedView(simulation).picture(0);
    const double edge = 320.0 + shift_px - 0.06 * simulation.lens.focal_px / z;
    const int left = static_cast<int>(edge) - 4;
    double white = 0.0;
    for (int x = left; x < left + 8; ++x) white += (*picture.at(x, 240) - 18.0) / (225.0 - 18.0);
    EXPECT_NEAR(left + white, edge, 0.05) << shift_px;
  }
}

TEST(SimulatedView, blurs_motion_over_the_exposure) {
  Simulation simulation = plain();
  auto path =
      HandPath::make({KeyPose{0.0, {-0.1, 0.0, 0.8}, 0, 0, 0}, KeyPose{1.0, {0.1, 0.0, 0.8}, 0, 0, 0}}, std::nullopt);
  ASSERT_TRUE(path.has_value());
  simulation.path = *std::move(path);
  const auto greys_between = [](const GreyImage& picture) {
    int count = 0;
    for (int x = 0; x < picture.width(); ++x) count += *picture.at(x, 240) > 30 && *picture.at(x, 240) < 80 ? 1 : 0;
    return count;
  };
  simulation.exposure_steps = 1;
  const int sharp = greys_between(SimulatedView(simulation).picture(15));
  simulation.exposure_steps = 8;
  simulation.exposure_s = 0.03;
  EXPECT_GT(greys_between(SimulatedView(simulation).picture(15)), sharp + 3);
}

TEST(SimulatedView, survives_arbitrary_poses_and_sizes) {
  for (const Eigen::Vector3d& position : std::initializer_list<Eigen::Vector3d>{
           {0, 0, 0}, {0, 0, 1e-9}, {0, 0, 0.01}, {50, 50, 0.001}, {0, 0, 100}, {0, 0, -5}, {-100, 100, 100}}) {
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 700}, std::pair{320, 240}}) {
      Simulation simulation = plain();
      simulation.path = still_at(position);
      simulation.lens = Pinhole::from_field_of_view(width, height, 1.0);
      EXPECT_EQ(SimulatedView(simulation).picture(0).width(), width);
    }
  }
  Simulation edge_on = plain();
  auto path = HandPath::make({KeyPose{0.0, {0.0, 0.0, 0.5}, 1.5707963267948966, 0, 0}}, std::nullopt);
  ASSERT_TRUE(path.has_value());
  edge_on.path = *std::move(path);
  EXPECT_FALSE(SimulatedView(edge_on).picture(0).empty());
}

TEST(SimulatedCamera, delivers_each_picture_when_its_exposure_ends) {
  FakeClock clock;
  Simulation simulation = plain();
  simulation.frames_per_second = 10.0;
  simulation.exposure_s = 0.02;
  SimulatedCamera camera(simulation, clock);
  EXPECT_FALSE(camera.next_frame(clock.now()).has_value());
  const TimePoint start = clock.now();
  ASSERT_TRUE(camera.start().has_value());
  const auto first = camera.next_frame(start + milliseconds(500));
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ((*first)->captured_at, start);
  EXPECT_EQ(clock.now(), start + milliseconds(20));
  clock.advance(milliseconds(415));
  const auto late = camera.next_frame(clock.now());
  ASSERT_TRUE(late.has_value());
  EXPECT_EQ((*late)->sequence, 4U);
  EXPECT_EQ((*late)->captured_at, start + milliseconds(400));
  const auto none = camera.next_frame(clock.now() + milliseconds(1));
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code(), ErrorCode::kTimedOut);
}

}  // namespace
}  // namespace cyclorama::simulated
