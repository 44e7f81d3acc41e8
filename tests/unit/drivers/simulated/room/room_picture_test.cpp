// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/room/room_picture.h"

#include <gtest/gtest.h>

#include "common/image/colour.h"

namespace cyclorama::simulated {
namespace {

constexpr const char* kRoom = R"(
name = "two projectors on a half circle"
[wall]
radius_m = 3.0
arc_deg = 120
bottom_m = 0.5
top_m = 2.5
[visitor]
eye_m = [0, 1.6, 0]
[[projector]]
name = "left"
width_px = 320
height_px = 240
field_of_view_deg = 50
position_m = [0, 2.4, 1.0]
pan_deg = -18
tilt_deg = -12
[[projector]]
name = "right"
width_px = 320
height_px = 240
field_of_view_deg = 50
position_m = [0, 2.4, 1.0]
pan_deg = 18
tilt_deg = -12
)";

class RoomPictureTest : public ::testing::Test {
 protected:
  RoomPictureTest()
      : installation_(*parse_installation(kRoom, "room")),
        room_(installation_, RoomEye::behind_visitor(installation_, 320, 180)) {}
  Installation installation_;
  RoomPicture room_;
  const RgbImage off_;
  const RgbImage grey_ = RgbImage(320, 240, 128);
};

TEST_F(RoomPictureTest, overlapping_light_adds_up_linearly) {
  const Point<frame::Room> seam = std::get<CylinderWall>(installation_.wall).point_at(0.0, 1.5);
  const float left = room_.radiance_at(seam, std::vector{grey_, off_})[0];
  const float right = room_.radiance_at(seam, std::vector{off_, grey_})[0];
  const float both = room_.radiance_at(seam, std::vector{grey_, grey_})[0];
  EXPECT_NEAR(left, 0.9f * srgb_to_linear(128.0f / 255.0f), 1e-6f);
  EXPECT_FLOAT_EQ(both, left + right);
}

TEST_F(RoomPictureTest, a_projector_lights_only_its_own_part) {
  const Point<frame::Room> far_left = std::get<CylinderWall>(installation_.wall).point_at(-0.7, 1.5);
  EXPECT_GT(room_.radiance_at(far_left, std::vector{grey_, grey_})[1], 0.0f);
  EXPECT_EQ(room_.radiance_at(far_left, std::vector{off_, grey_})[1], 0.0f);
}

TEST_F(RoomPictureTest, a_lit_pixel_appears_where_its_ray_meets_the_wall) {
  RgbImage dot(320, 240, 0);
  for (int c = 0; c < 3; ++c) dot.at(200, 100)[c] = 255;
  const InstalledProjector& left = installation_.projectors[0];
  const RoomRay ray{{left.T_room_projector.translation()},
                    left.T_room_projector.rotation() * left.lens.direction_at(200.5, 100.5)};
  const auto met = hit(installation_.wall, ray);
  ASSERT_TRUE(met.has_value());
  EXPECT_NEAR(room_.radiance_at(*met, std::vector{dot, off_})[2], 0.9f, 1e-3f);
}

TEST_F(RoomPictureTest, a_dark_room_is_black_and_a_lit_wall_lights_the_floor) {
  const RgbImage dark = room_.photograph(std::vector{off_, off_});
  const RgbImage lit = room_.photograph(std::vector{RgbImage(320, 240, 255), RgbImage(320, 240, 255)});
  EXPECT_LT(*std::max_element(dark.data().begin(), dark.data().end()), 40);
  EXPECT_GT(lit.at(160, 85)[0], 200);                         // The wall in front of the eye.
  EXPECT_GT(lit.at(160, 175)[0], dark.at(160, 175)[0] + 20);  // The floor below it.
}

}  // namespace
}  // namespace cyclorama::simulated
