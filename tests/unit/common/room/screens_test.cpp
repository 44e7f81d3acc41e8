// SPDX-License-Identifier: Apache-2.0
// Walls of every shape from their settings, and the pictures that cover them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "common/geometry/picture_place.h"
#include "common/room/installation.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/wall_meshes.h"

namespace cyclorama {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

std::string room_of(const std::string& wall, const std::string& eye = "[0.0, 1.6, 0.0]") {
  return "name = \"room\"\n[wall]\n" + wall + "\n[visitor]\neye_m = " + eye +
         "\n[[projector]]\nname = \"one\"\nwidth_px = 320\nheight_px = 240\nfield_of_view_deg = 60\n"
         "position_m = [0.0, 2.0, 0.5]\n";
}
std::string complaint(const std::string& text) {
  const auto room = parse_installation(text, "room.toml");
  return room ? "" : room.error().message();
}
Installation made(const std::string& text) {
  auto room = parse_installation(text, "room.toml");
  EXPECT_TRUE(room) << room.error().message();
  return room ? *std::move(room) : Installation{};
}

/// Expects that the picture shows the whole wall.
void expect_covers(const Installation& room, const PictureShape& picture) {
  ASSERT_TRUE(validate(picture)) << validate(picture).error().message();
  double min_u = 1e9, max_u = -1e9, min_v = 1e9, max_v = -1e9;
  for (const WallPatch& patch : patches(room.wall, 4000)) {
    const auto p = pixel_of(picture, patch.middle.xyz - room.sweet_spot.xyz);
    ASSERT_TRUE(p);
    min_u = std::min(min_u, p->u);
    max_u = std::max(max_u, p->u);
    min_v = std::min(min_v, p->v);
    max_v = std::max(max_v, p->v);
  }
  EXPECT_GE(min_u, -1.0);
  EXPECT_GE(min_v, -1.0);
  EXPECT_LE(max_u, width_px(picture) + 1.0);
  EXPECT_LE(max_v, height_px(picture) + 1.0);
  // The picture is also no larger than necessary in the limiting direction.
  const auto* fisheye = std::get_if<Fisheye>(&picture);
  const double side = fisheye != nullptr ? 2.0 * fisheye->radius_px() : std::max(width_px(picture), height_px(picture));
  EXPECT_GT(std::max(max_u - min_u, max_v - min_v), 0.9 * side);
}

const std::string kPlane = "shape = \"plane\"\ncentre_m = [0, 1.6, -3]\nwidth_m = 4\nheight_m = 2\n";
const std::string kCorner =
    "shape = \"planes\"\ncorners_m = [[-2, 0], [-2, -2], [2, -2], [2, 0]]\nbottom_m = 0.2\ntop_m = 2.6\n";
const std::string kDome = "shape = \"dome\"\ncentre_m = [0, 1.6, 0]\nradius_m = 3.0\nfield_deg = 160\ntilt_deg = 50\n";

TEST(Screens, one_plane_needs_a_perspective_picture) {
  const Installation room = made(room_of(kPlane + "pan_deg = 10\ntilt_deg = 15\n", "[0.3, 1.2, 0.2]"));
  const auto picture = room.picture(1000);
  ASSERT_TRUE(std::holds_alternative<Perspective>(picture));
  EXPECT_GT(std::get<Perspective>(picture).tilt_rad, 10 * kDegree);
  expect_covers(room, picture);
  // Straight ahead and level, the picture equals the wall.
  const auto ahead = std::get<Perspective>(made(room_of(kPlane)).picture(1000));
  EXPECT_NEAR(ahead.tan_right, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(ahead.tan_left, -2.0 / 3.0, 1e-12);
  EXPECT_EQ(ahead.height_px, 500);
}

TEST(Screens, a_plane_beside_the_eye_is_too_wide_for_a_flat_picture) {
  // The eye is 2 cm in front of the wall: 179 degrees across.
  const Installation room = made(room_of(kPlane, "[0.0, 1.6, -2.98]"));
  const auto picture = room.picture(1000);
  EXPECT_TRUE(std::holds_alternative<Fisheye>(picture));
  expect_covers(room, picture);
}

TEST(Screens, planes_with_corners_need_a_panorama) {
  const Installation room = made(room_of(kCorner));
  const auto picture = room.picture(1000);
  ASSERT_TRUE(std::holds_alternative<Panorama>(picture));
  EXPECT_NEAR(std::get<Panorama>(picture).azimuth_span_rad, kPi, 1e-9);
  expect_covers(room, picture);
  const Installation closed = made(
      room_of("shape = \"planes\"\ncorners_m = [[0, 2], [-2, 2], [-2, -2], [2, -2], [2, 2], [0, 2]]\ntop_m = 2.6\n"));
  EXPECT_EQ(std::get<Panorama>(closed.picture(1000)).azimuth_span_rad, 2.0 * kPi);
}

TEST(Screens, a_floor_needs_a_fisheye) {
  const Installation room =
      made(room_of(kCorner + "[[wall.plane]]\ncentre_m = [0, 0.2, -1]\nwidth_m = 4\nheight_m = 2\ntilt_deg = -90\n"));
  ASSERT_EQ(std::get<PlanesWall>(room.wall).rectangles.size(), 4u);
  EXPECT_GT(std::get<PlanesWall>(room.wall).rectangles[3].normal().y(), 0.999);
  const auto picture = room.picture(1000);
  ASSERT_TRUE(std::holds_alternative<Fisheye>(picture));
  EXPECT_GT(std::get<Fisheye>(picture).field_rad, kPi);
  expect_covers(room, picture);
}

TEST(Screens, a_dome_needs_a_fisheye_about_its_axis_with_a_margin) {
  const Installation room = made(room_of(kDome));
  const auto picture = std::get<Fisheye>(room.picture(1000));
  EXPECT_NEAR(picture.tilt_rad, 50 * kDegree, 1e-12);
  EXPECT_GT(0.5 * picture.field_rad, 80 * kDegree + picture.radians_per_px());
  EXPECT_LT(0.5 * picture.field_rad, 80 * kDegree + 2.0 * picture.radians_per_px());
  expect_covers(room, picture);
  expect_covers(made(room_of(kDome, "[0.4, 1.2, 0.5]")), made(room_of(kDome, "[0.4, 1.2, 0.5]")).picture(700, 500));
}

TEST(Screens, reads_the_demos) {
  for (const char* const name : {"plane", "corner", "dome", "mesh"}) {
    const auto room = read_installation(demo_installation_path().parent_path() / (std::string(name) + ".toml"));
    ASSERT_TRUE(room) << room.error().message();
    expect_covers(*room, room->picture(768));
  }
}

TEST(Screens, refuses_walls_behind_the_eye) {
  EXPECT_THAT(complaint(room_of(kPlane, "[0, 1.6, -4]")),
              AllOf(StartsWith("room.toml:9: visitor.eye_m: is behind the wall"), HasSubstr("turn the wall")));
  EXPECT_THAT(complaint(room_of("shape = \"planes\"\ncorners_m = [[2, -2], [-2, -2]]\ntop_m = 2\n")),
              HasSubstr("corners_m go from the visitor's left to right"));
  EXPECT_THAT(complaint(room_of(kDome, "[0, 1.6, 4]")), HasSubstr("outside the dome"));
  const std::string behind =
      room_of("shape = \"plane\"\ncentre_m = [0, 1.6, 0.2]\nwidth_m = 4\nheight_m = 2\npan_deg = 180\n");
  EXPECT_THAT(complaint(behind), HasSubstr("projector[0].position_m"));
}

TEST(Screens, names_the_line_of_a_mistake) {
  EXPECT_THAT(complaint(room_of("shape = \"cone\"\n")), StartsWith("room.toml:3: wall.shape"));
  EXPECT_THAT(complaint(room_of(kPlane + "radius_m = 3\n")), StartsWith("room.toml:7: wall.radius_m"));
  EXPECT_THAT(complaint(room_of("shape = \"planes\"\n")), HasSubstr("[[wall.plane]]"));
  EXPECT_THAT(complaint(room_of("shape = \"planes\"\ncorners_m = [[0, -2]]\ntop_m = 2\n")), HasSubstr("two corners"));
  EXPECT_THAT(complaint(room_of("shape = \"planes\"\ncorners_m = [[0, -2], [0.01, -2]]\ntop_m = 2\n")),
              HasSubstr("within 0.05 m"));
  EXPECT_THAT(complaint(room_of("shape = \"dome\"\ncentre_m = [0, 1, 0]\nradius_m = 3\nfield_deg = 400\n")),
              HasSubstr("wall.field_deg"));
  EXPECT_THAT(complaint(room_of("shape = \"mesh\"\nfile = \"../wall.obj\"\n")), HasSubstr("not a path"));
  EXPECT_THAT(complaint(room_of("shape = \"mesh\"\nfile = \"none.obj\"\n")),
              AllOf(StartsWith("room.toml:4: wall.file"), HasSubstr("none.obj")));
}

TEST(Screens, finds_a_mesh_beside_its_installation) {
  const std::filesystem::path folder = testing::TempDir() + "/screens";
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& text) { std::ofstream(folder / "wall.obj") << text; };
  const std::string text = room_of("shape = \"mesh\"\nfile = \"wall.obj\"\n");
  write(obj_of({.radius_m = 3.0, .arc_rad = 2.0, .bottom_m = 0.5, .top_m = 2.5}, 30, 4));
  const auto room = parse_installation(text, "room.toml", folder);
  ASSERT_TRUE(room) << room.error().message();
  EXPECT_TRUE(std::holds_alternative<Panorama>(room->picture(1000)));
  expect_covers(*room, room->picture(1000));
  write("v 0 0 0\nf 1 1 1\n");
  const auto bad = parse_installation(text, "room.toml", folder);
  ASSERT_FALSE(bad);
  EXPECT_THAT(bad.error().message(),
              AllOf(StartsWith("room.toml:4: wall.file: 'wall.obj' line 2"), HasSubstr("no area")));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cyclorama
