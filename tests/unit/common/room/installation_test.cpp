// SPDX-License-Identifier: Apache-2.0
#include "common/room/installation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace cyclorama {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kRoom = R"(name = "room"
[wall]
radius_m = 3.0
arc_deg = 180.0
top_m = 2.6
[visitor]
eye_m = [0.0, 1.6, 0.0]
[[projector]]
name = "left"
width_px = 1280
height_px = 800
field_of_view_deg = 60
position_m = [0.5, 2.5, 1.0]
pan_deg = -60
)";

std::string with(std::string text, const std::string& old_line, const std::string& new_line) {
  const std::size_t at = text.find(old_line);
  EXPECT_NE(at, std::string::npos) << old_line;
  return text.replace(at, old_line.size(), new_line);
}

std::string complaint(const std::string& text) {
  const auto installation = parse_installation(text, "room.toml");
  return installation ? "" : installation.error().message();
}

TEST(Installation, reads_a_room_with_its_units) {
  const auto room = parse_installation(kRoom, "room.toml");
  ASSERT_TRUE(room.has_value()) << room.error().message();
  EXPECT_NEAR(std::get<CylinderWall>(room->wall).arc_rad, std::numbers::pi, 1e-12);
  ASSERT_EQ(room->projectors.size(), 1u);
  EXPECT_EQ(room->projectors[0].name, "left");
  EXPECT_EQ(room->projectors[0].lens.width_px, 1280);
}

TEST(Installation, reads_another_programs_warp_beside_it) {
  EXPECT_FALSE(parse_installation(kRoom, "room.toml")->projectors[0].warp.has_value());
  const auto room = parse_installation(kRoom + "warp = 'wall.mpcdi'\nwarp_region = 'l'\n", "room.toml", "/museum");
  ASSERT_TRUE(room.has_value()) << room.error().message();
  ASSERT_TRUE(room->projectors[0].warp.has_value());
  EXPECT_EQ(room->projectors[0].warp->file, "/museum/wall.mpcdi");
  EXPECT_EQ(room->projectors[0].warp->region, "l");
  EXPECT_TRUE(room->projectors[0].warp->mask.empty());
  const auto pair = parse_installation(kRoom + "warp = 'l.pfm'\nwarp_mask = 'l.png'\n", "room.toml", "/museum");
  ASSERT_TRUE(pair.has_value()) << pair.error().message();
  EXPECT_EQ(pair->projectors[0].warp->mask, "/museum/l.png");
}

TEST(Installation, refuses_a_warp_outside_its_folder_or_an_incomplete_one) {
  for (const char* const name : {"../wall.mpcdi", "/wall.mpcdi", ""}) {
    EXPECT_THAT(complaint(kRoom + "warp = '" + name + "'\n"),
                AllOf(StartsWith("room.toml:"), HasSubstr("beside the installation")))
        << name;
  }
  EXPECT_THAT(complaint(kRoom + "warp_region = 'l'\n"), HasSubstr("warp_region"));
}

TEST(Installation, a_pan_to_the_left_looks_left_and_upright) {
  const auto room = parse_installation(kRoom, "room.toml");
  ASSERT_TRUE(room.has_value());
  const auto& T = room->projectors[0].T_room_projector;
  const Point<frame::Room> ahead = T * Point<frame::Projector>{Eigen::Vector3d(0, 0, 1)};
  const Eigen::Vector3d look = ahead.xyz - Eigen::Vector3d(0.5, 2.5, 1.0);
  EXPECT_NEAR(look.x(), -std::sin(std::numbers::pi / 3.0), 1e-12);
  EXPECT_NEAR(look.z(), -std::cos(std::numbers::pi / 3.0), 1e-12);
  const Point<frame::Room> below = T * Point<frame::Projector>{Eigen::Vector3d(0, 1, 0)};
  EXPECT_NEAR(below.xyz.y(), 1.5, 1e-12);  // y points down in a projector.
}

TEST(Installation, tilt_looks_up_and_lens_shift_moves_the_centre) {
  const auto room = parse_installation(kRoom + "tilt_deg = 30\nlens_shift_fraction = [0.0, -0.5]\n", "room.toml");
  ASSERT_TRUE(room.has_value()) << room.error().message();
  const auto& projector = room->projectors[0];
  const Point<frame::Room> ahead = projector.T_room_projector * Point<frame::Projector>{Eigen::Vector3d(0, 0, 1)};
  EXPECT_NEAR(ahead.xyz.y() - 2.5, 0.5, 1e-12);
  EXPECT_NEAR(projector.lens.centre_v_px, 0.0, 1e-9);
}

TEST(Installation, the_panorama_covers_the_wall_from_the_sweet_spot) {
  for (const char* const eye : {"[0.0, 1.6, 0.0]", "[1.0, 1.2, -0.8]"}) {
    const auto room = parse_installation(with(kRoom, "[0.0, 1.6, 0.0]", eye), "room.toml");
    ASSERT_TRUE(room.has_value());
    const Panorama panorama = room->panorama(2048);
    EXPECT_TRUE(panorama.validate().has_value());
    for (double angle = -1.57; angle <= 1.57; angle += 0.05) {
      for (const double height : {0.0, 1.3, 2.6}) {
        const Eigen::Vector3d d = std::get<CylinderWall>(room->wall).point_at(angle, height).xyz - room->sweet_spot.xyz;
        const PanoramaPixel p = panorama.pixel_of(d);
        EXPECT_GE(p.u, -1.0);
        EXPECT_LE(p.u, 2049.0);
        EXPECT_GE(p.v, -1.0);
        EXPECT_LE(p.v, panorama.height_px + 1.0);
      }
    }
  }
}

TEST(Installation, demands_that_each_of_several_projectors_can_be_found_again) {
  const std::string other = with(kRoom.substr(kRoom.find("[[projector]]")), "\"left\"", "\"right\"");
  const auto fault = [](const std::string& text) {
    const auto room = parse_installation(text, "room.toml");
    EXPECT_TRUE(room) << room.error().message();
    const Status checked = check_connectors(*room);
    return checked ? std::string() : checked.error().message();
  };
  EXPECT_EQ(fault(kRoom), "");
  EXPECT_THAT(fault(kRoom + other), HasSubstr("projector 'left' has neither 'connector' nor 'serial'"));
  EXPECT_THAT(fault(kRoom + "connector = \"DP-1\"\n" + other), HasSubstr("projector 'right'"));
  EXPECT_EQ(fault(kRoom + "connector = \"DP-1\"\n" + other + "serial = \"X4\"\n"), "");
}

TEST(Installation, reads_a_projectors_connector) {
  const auto room = parse_installation("cards = [\"/dev/dri/card1\", \"/dev/dri/card0\"]\n" + kRoom +
                                           "connector = \"HDMI-A-2\"\ncard = 1\nturn_deg = 270\n",
                                       "room.toml");
  ASSERT_TRUE(room.has_value()) << room.error().message();
  EXPECT_THAT(room->cards, testing::ElementsAre("/dev/dri/card1", "/dev/dri/card0"));
  const Plug& plug = room->projectors[0].plug;
  EXPECT_EQ(plug.connector, "HDMI-A-2");
  EXPECT_EQ(plug.card, 1);
  EXPECT_EQ(plug.turn_deg, 270);
  const auto extended = parse_installation(kRoom + "connector = \"DP-1\"\nedid = \"left.edid\"\nconnect = \"always\"\n",
                                           "room.toml", "/etc/museum");
  ASSERT_TRUE(extended) << extended.error().message();
  EXPECT_EQ(extended->projectors[0].plug.edid, "/etc/museum/left.edid");
  EXPECT_TRUE(extended->projectors[0].plug.is_always_connected);
  EXPECT_EQ(parse_installation(kRoom + "serial = \"X4\"\n", "room.toml")->projectors[0].plug.serial, "X4");
  const auto plain = parse_installation(kRoom, "room.toml");
  EXPECT_TRUE(plain->projectors[0].plug.edid.empty());
  EXPECT_FALSE(plain->projectors[0].plug.is_always_connected);
  EXPECT_TRUE(plain->cards.empty());
  EXPECT_EQ(plain->projectors[0].plug.connector, "");
  EXPECT_EQ(plain->projectors[0].plug.card, std::nullopt);
  EXPECT_EQ(plain->projectors[0].plug.turn_deg, 0);

  EXPECT_THAT(complaint(kRoom + "turn_deg = 45\n"), HasSubstr("turn_deg"));
  EXPECT_THAT(complaint(kRoom + "turn_deg = 360\n"), HasSubstr("turn_deg"));
  EXPECT_THAT(complaint(kRoom + "card = 1\n"), HasSubstr("without a 'connector'"));
  EXPECT_THAT(complaint(kRoom + "card = -1\nconnector = \"DP-1\"\n"), HasSubstr("projector[0].card"));
  EXPECT_THAT(complaint(kRoom + "connector = \"1:DP-1\"\n"), HasSubstr("write card = 1"));
  EXPECT_THAT(complaint("cards = \"/dev/dri/card0\"\n" + kRoom), HasSubstr("room.toml:1: cards"));
  const std::string other = with(kRoom.substr(kRoom.find("[[projector]]")), "\"left\"", "\"right\"");
  EXPECT_THAT(complaint(kRoom + "connector = \"DP-1\"\n" + other + "connector = \"DP-1\"\n"),
              HasSubstr("the connector of 'left' too"));
  EXPECT_EQ(complaint(kRoom + "connector = \"DP-1\"\n" + other + "connector = \"DP-1\"\ncard = 1\n"), "");
  EXPECT_THAT(complaint(kRoom + "serial = \"X4\"\n" + other + "serial = \"X4\"\n"),
              HasSubstr("the serial of 'left' too"));
  EXPECT_THAT(complaint(kRoom + "connector = \"DP-1\"\nserial = \"X4\"\n"), HasSubstr("leave one out"));
  EXPECT_THAT(complaint(kRoom + "edid = \"a/b\"\n"), HasSubstr("a file beside the installation"));
  EXPECT_THAT(complaint(kRoom + "serial = \"X4\"\nedid = \"x.edid\"\n"), HasSubstr("'serial' cannot find it"));
  EXPECT_THAT(complaint(kRoom + "connect = \"perhaps\"\n"), HasSubstr("connect"));
  EXPECT_THAT(complaint(kRoom + "connector = \"DP-1\"\nconnect = \"always\"\n"), HasSubstr("needs 'connector'"));
  EXPECT_THAT(complaint(kRoom + "edid = \"x.edid\"\nconnect = \"always\"\n"), HasSubstr("needs 'connector'"));
}

TEST(Installation, reads_how_a_projector_is_switched) {
  const auto room =
      parse_installation(kRoom + "pjlink = \"192.0.2.11\"\npjlink_password_file = \"pw\"\n", "room.toml", "/etc/c");
  ASSERT_TRUE(room.has_value()) << room.error().message();
  const auto& pjlink = room->projectors[0].pjlink;
  ASSERT_TRUE(pjlink);
  EXPECT_EQ(pjlink->address.host, "192.0.2.11");
  EXPECT_EQ(pjlink->address.port, 4352);
  EXPECT_EQ(pjlink->password_file, "/etc/c/pw");
  const auto other = parse_installation(kRoom + "pjlink = \"[2001:db8::11]:99\"\n", "room.toml");
  ASSERT_TRUE(other.has_value());
  EXPECT_EQ(other->projectors[0].pjlink->address.host, "2001:db8::11");
  EXPECT_EQ(other->projectors[0].pjlink->address.port, 99);
  EXPECT_EQ(other->projectors[0].pjlink->password_file, "");
  EXPECT_FALSE(parse_installation(kRoom, "room.toml")->projectors[0].pjlink);
  EXPECT_THAT(complaint(kRoom + "pjlink = \"2001:db8::11\"\n"), HasSubstr("must be HOST or HOST:PORT"));
  EXPECT_THAT(complaint(kRoom + "pjlink = \"a:b:c\"\n"), HasSubstr("projector[0].pjlink"));
  EXPECT_THAT(complaint(kRoom + "pjlink_password_file = \"pw\"\n"), HasSubstr("needs 'pjlink'"));
}

TEST(Installation, names_the_line_of_a_mistake) {
  EXPECT_THAT(complaint(with(kRoom, "radius_m = 3.0", "radius_mm = 3000")),
              HasSubstr("write 'radius_m', in that unit"));
  EXPECT_THAT(complaint(with(kRoom, "radius_m = 3.0", "radius_m = -3.0")), StartsWith("room.toml:3: wall.radius_m"));
  EXPECT_THAT(complaint(with(kRoom, "top_m = 2.6", "top_m = -2.6")), StartsWith("room.toml:5: wall.top_m"));
  EXPECT_THAT(complaint(with(kRoom, "[0.0, 1.6, 0.0]", "[0.0, 1.6, 3.5]")), StartsWith("room.toml:7: visitor.eye_m"));
  EXPECT_THAT(complaint(with(kRoom, "[0.5, 2.5, 1.0]", "[0.5, 2.5, 4.0]")), HasSubstr("outside the wall"));
  EXPECT_THAT(complaint(with(kRoom, "name = \"left\"", "nane = \"left\"")), HasSubstr("did you mean 'name'"));
  EXPECT_THAT(complaint(kRoom + kRoom.substr(kRoom.find("[[projector]]"))), HasSubstr("another projector"));
  EXPECT_THAT(complaint(kRoom.substr(0, kRoom.find("[[projector]]"))), HasSubstr("at least one [[projector]]"));
}

std::string in_stereo(const std::string& lines) { return with(kRoom, "[wall]", "[stereo]\n" + lines + "\n[wall]"); }

TEST(Installation, reads_stereo_heads) {
  EXPECT_FALSE(parse_installation(kRoom, "room.toml")->stereo.has_value());
  for (const auto& [word, packing] :
       {std::pair("side-by-side", StereoPacking::kSideBySide), std::pair("top-bottom", StereoPacking::kTopBottom),
        std::pair("frame-sequential", StereoPacking::kFrameSequential)}) {
    const auto room = parse_installation(in_stereo(std::string("packing = '") + word + "'"), "room.toml");
    ASSERT_TRUE(room.has_value()) << room.error().message();
    ASSERT_TRUE(room->stereo.has_value());
    EXPECT_EQ(room->stereo->packing, packing);
    EXPECT_EQ(room->stereo->eye_distance_m, 0.063);
  }
  EXPECT_THAT(complaint(in_stereo("packing = 'anaglyph'")), AllOf(HasSubstr("room.toml:3"), HasSubstr("packing")));
  EXPECT_THAT(complaint(in_stereo("eye_distance_m = 0.06")), HasSubstr("packing"));
  EXPECT_THAT(complaint(in_stereo("packing = 'top-bottom'\neye_distance_m = 0")), HasSubstr("eye_distance_m"));
}

TEST(Installation, requires_a_side_that_two_eyes_can_share) {
  const std::string odd = with(in_stereo("packing = 'side-by-side'"), "width_px = 1280", "width_px = 1281");
  EXPECT_THAT(complaint(odd), AllOf(HasSubstr("width_px"), HasSubstr("even")));
  const std::string high = with(in_stereo("packing = 'top-bottom'"), "height_px = 800", "height_px = 801");
  EXPECT_THAT(complaint(high), AllOf(HasSubstr("height_px"), HasSubstr("even")));
  EXPECT_EQ(complaint(with(odd, "side-by-side", "frame-sequential")), "");
  EXPECT_EQ(complaint(with(high, "top-bottom", "side-by-side")), "");
}

TEST(Installation, eyes_converge_on_the_wall) {
  auto room = *parse_installation(in_stereo("packing = 'side-by-side'\neye_distance_m = 0.06"), "room.toml");
  const Projection picture = room.projection(1000);
  EXPECT_EQ(picture.viewing.eyes, Eyes::kOverUnder);
  EXPECT_EQ(picture.viewing.eye_distance_m, 0.06);
  EXPECT_NEAR(picture.viewing.screen_distance_m, 3.0, 1e-9);
  EXPECT_EQ(height_px(picture.shape) % 16, 0);
  EXPECT_LT(height_px(picture.shape) - height_px(room.picture(1000)), 16);
  EXPECT_EQ(width_px(picture.shape), 1000);
  EXPECT_TRUE(picture.validate());
  room.stereo.reset();
  EXPECT_EQ(room.projection(1000), (Projection{room.picture(1000), {}}));
  // A wall tilted by 0.3 rad, 2 m away along its axis, wherever on it the eye looks.
  const Point<frame::Room> middle{Eigen::Vector3d(0.0, 1.6 + 2.0 * std::sin(0.3), -2.0 * std::cos(0.3))};
  room.wall = PlanesWall{{WallRectangle::facing(middle, 0.0, 0.3, 3.0, 2.0)}};
  EXPECT_NEAR(room.screen_distance_m(room.picture(800)), 2.0, 1e-9);
}

}  // namespace
}  // namespace cyclorama
