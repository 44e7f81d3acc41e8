// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/simulated_show.h"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/simulated/museum/presets.h"

namespace cyclorama::simulated {
namespace {

Preset small_preset() {
  PresetOptions options;
  options.projector_width_px = 320;
  options.projector_height_px = 180;
  options.camera_megapixels = 0.05;
  Preset preset = *make_preset("cylinder126", 3, options);
  preset.truth.cells = 24;
  preset.truth.camera.line_time_s = 0.0;
  preset.truth.camera.bits = 12;
  return preset;
}

RgbImage chequers(int side) {
  RgbImage picture(320, 180);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x)
      std::fill_n(picture.at(x, y), 3, static_cast<std::uint8_t>((x / side + y / side) % 2 == 0 ? 220 : 30));
  }
  return picture;
}

SimulatedShow show_of(const Preset& preset, const RigidTransform<frame::Room, frame::Camera>& pose) {
  return *SimulatedShow::make(preset.installation, preset.truth, {{preset.truth.camera, pose}});
}

double mean(const GreyImage& picture) {
  double sum = 0.0;
  for (const std::uint8_t code : picture.data()) sum += code;
  return sum / static_cast<double>(picture.data().size());
}

TEST(SimulatedShow, agrees_with_the_turntables_camera_in_the_same_pose) {
  const Preset preset = small_preset();
  auto museum = SimulatedMuseum::make(preset.installation, preset.truth);
  ASSERT_TRUE(museum);
  SimulatedShow show = show_of(preset, museum->truth().camera_pose(museum->true_turntable_angle_rad()));
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(museum->show(i, chequers(20)));
    ASSERT_TRUE(show.show(i, chequers(20)));
  }
  museum->settle();
  const GreyImage turntable = to_8_bits(*museum->photograph_grey(0.02), 12);
  const GreyImage fixed = *show.photograph(0, 0.02);
  ASSERT_EQ(fixed.width(), turntable.width());
  double squares = 0.0;
  for (std::size_t i = 0; i < turntable.data().size(); ++i)
    squares += std::pow(turntable.data()[i] - fixed.data()[i], 2.0);
  // Both have independent noise: shot noise of a bright pixel is 1.5 codes.
  EXPECT_LT(std::sqrt(squares / static_cast<double>(turntable.data().size())), 3.0);
  EXPECT_GT(mean(fixed), 10.0);
}

TEST(SimulatedShow, a_visitor_hides_and_shades_the_wall_until_removed) {
  const Preset preset = small_preset();
  auto museum = SimulatedMuseum::make(preset.installation, preset.truth);
  SimulatedShow show = show_of(preset, museum->truth().camera_pose(0.0));
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(show.show(i, RgbImage(320, 180, 255)));
  const double free = mean(*show.photograph(0, 0.02));
  show.set_visitors({{0.0, -2.0, 0.3, 1.8, 0.05}});
  EXPECT_LT(mean(*show.photograph(0, 0.02)), 0.97 * free);
  show.set_visitors({});
  EXPECT_NEAR(mean(*show.photograph(0, 0.02)), free, 0.01 * free);
}

TEST(SimulatedShow, a_displaced_projector_lights_another_part_once_it_shows_again) {
  const Preset preset = small_preset();
  auto museum = SimulatedMuseum::make(preset.installation, preset.truth);
  SimulatedShow show = show_of(preset, museum->truth().camera_pose(0.0));
  ASSERT_TRUE(show.show(1, chequers(40)));
  const GreyImage before = *show.photograph(0, 0.02);
  const auto T = preset.truth.projectors[1].T_room_projector;
  const RigidTransform<frame::Room, frame::Projector> turned(
      T.rotation() * Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY())), T.translation());
  ASSERT_TRUE(show.move_projector(1, turned));
  ASSERT_TRUE(show.show(1, chequers(40)));
  const GreyImage after = *show.photograph(0, 0.02);
  int changed = 0;
  for (std::size_t i = 0; i < before.data().size(); ++i)
    changed += std::abs(before.data()[i] - after.data()[i]) > 10 ? 1 : 0;
  EXPECT_GT(changed, static_cast<int>(before.data().size()) / 50);
  EXPECT_FALSE(show.show(7, chequers(40)));
  EXPECT_FALSE(show.photograph(3, 0.02));
}

}  // namespace
}  // namespace cyclorama::simulated
