// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/scene_package.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace cyclorama::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ScenePackageTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("package_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_ / "in");
    std::ofstream(folder_ / "a.ply") << "ply";
    std::ofstream(folder_ / "in" / "b.ply") << "ply";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Result<ScenePackage> parse(const std::string& text) const { return parse_scene_package(text, "scene.toml", folder_); }
  std::string complaint(const std::string& text) const {
    const auto package = parse(text);
    return package ? "" : package.error().message();
  }
  std::filesystem::path folder_;
};

const std::string kMinimalPackage = "title = 'x'\n[[geometry]]\nfile = 'a.ply'\n";

TEST_F(ScenePackageTest, the_smallest_package_has_a_title_and_a_file) {
  const auto package = parse(kMinimalPackage);
  ASSERT_TRUE(package.has_value()) << package.error().message();
  EXPECT_EQ(package->title, "x");
  ASSERT_EQ(package->geometry.size(), 1u);
  EXPECT_EQ(package->geometry[0].unit_m, 1.0);
  EXPECT_TRUE(package->geometry[0].T_scene_part[0].isApprox(Eigen::Affine3d::Identity()));
  EXPECT_FALSE(package->start_eye || package->sky || package->exposure || package->eye_lamp || package->ambient);
}

TEST_F(ScenePackageTest, bounces_have_a_default) {
  EXPECT_EQ(parse(kMinimalPackage)->bounces, kUsualBounces);
  EXPECT_EQ(parse("bounces = 0\n" + kMinimalPackage)->bounces, 0);
  EXPECT_EQ(parse("bounces = 64\n" + kMinimalPackage)->bounces, 64);
  EXPECT_THAT(complaint("bounces = 65\n" + kMinimalPackage), HasSubstr("bounces"));
}

TEST_F(ScenePackageTest, every_key_is_read) {
  const auto package = parse(R"(
title = "Grotto"
credits = "me"
unit_m = 0.001
up = "z"
exposure = 2.5
[tone]
curve = "filmic"
[start]
eye_m = [1, 2, 3]
heading_deg = 90
[visitor]
eye_height_m = 1.5
walking_scale = 2
walkable_m = [[0, 0], [9, 0], [9, 9], [0, 9]]
[sky]
zenith = [1, 2, 3]
[light]
ambient = [0.1, 0.1, 0.2]
eye_lamp_cd = [5, 5, 5]
[[lamp]]
kind = "spot"
position_m = [0, 3, 0]
direction = [0, -2, 0]
intensity_cd = [10, 10, 10]
radius_m = 0.1
inner_cone_deg = 20
outer_cone_deg = 30
[[lamp]]
kind = "directional"
direction = [1, 0, 0]
intensity_lux = [3, 3, 3]
angular_radius_deg = 45
[[geometry]]
file = "in/b.ply"
unit_m = 1
up = "y"
[[geometry]]
file = "a.ply"
[[stop]]
title = "niche"
eye_m = [4, 5, 6]
heading_deg = -90
)");
  ASSERT_TRUE(package.has_value()) << package.error().message();
  EXPECT_EQ(package->exposure, 2.5);
  EXPECT_EQ(package->tone, ToneCurve::kFilmic);
  EXPECT_EQ(*package->start_eye, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(*package->start_heading_rad, 0.5 * std::numbers::pi, 1e-12);
  EXPECT_EQ(package->walkable.size(), 4u);
  EXPECT_EQ(package->sky->zenith, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(package->sky->ground, Eigen::Vector3f::Zero());
  ASSERT_EQ(package->lamps.size(), 2u);
  EXPECT_EQ(package->lamps[0].direction, Eigen::Vector3d(0, -1, 0));
  EXPECT_NEAR(package->lamps[0].outer_cone_rad, std::numbers::pi / 6.0, 1e-12);
  EXPECT_NEAR(package->lamps[1].radius_m, 1.0, 1e-12) << "the tangent of the angular radius";
  EXPECT_FALSE(package->geometry[0].z_up);
  EXPECT_TRUE(package->geometry[1].z_up);
  EXPECT_EQ(package->geometry[1].unit_m, 0.001);
  EXPECT_NEAR(package->stops[0].heading_rad, -0.5 * std::numbers::pi, 1e-12);
}

TEST_F(ScenePackageTest, flat_lamps_are_read) {
  const auto package = parse(kMinimalPackage + R"(
[[lamp]]
kind = "rectangle"
position_m = [0, 3, 0]
size_m = [2, 1]
flux_lm = [6.283185307179586, 0, 0]
[[lamp]]
kind = "rectangle"
position_m = [0, 1, 5]
direction = [0, 0, -3]
rotation_deg = 90
size_m = [1, 1]
luminance_nits = [3, 4, 5]
visible = false
[[lamp]]
kind = "disk"
position_m = [0, 3, 0]
radius_m = 0.5
luminance_nits = [3, 4, 5]
[[lamp]]
kind = "point"
position_m = [0, 3, 0]
radius_m = 0.5
intensity_cd = [3, 4, 5]
visible = true
)");
  ASSERT_TRUE(package.has_value()) << package.error().message();
  ASSERT_EQ(package->lamps.size(), 4u);
  const Light& ceiling = package->lamps[0];
  EXPECT_EQ(ceiling.kind, LightKind::kRectangle);
  EXPECT_EQ(ceiling.direction, Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(ceiling.across, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(ceiling.size_m, Eigen::Vector2d(2, 1));
  EXPECT_NEAR(ceiling.intensity.x(), 1.0f, 1e-6f) << "lumens over pi and square metres";
  EXPECT_TRUE(ceiling.visible);
  const Light& wall = package->lamps[1];
  EXPECT_LT((wall.across - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12) << "+x, turned clockwise for who looks along -z";
  EXPECT_FALSE(wall.visible);
  EXPECT_EQ(package->lamps[2].kind, LightKind::kDisk);
  EXPECT_EQ(package->lamps[2].radius_m, 0.5);
  EXPECT_TRUE(package->lamps[3].visible);
}

std::string lamp_of_group(std::string_view group) {
  return fmt::format("[[lamp]]\nkind = \"point\"\nposition_m = [0, 1, 0]\nintensity_cd = [1, 1, 1]\ngroup = \"{}\"\n",
                     group);
}

TEST_F(ScenePackageTest, lamps_of_one_group_share_its_number_and_others_have_none) {
  const auto package =
      parse(kMinimalPackage + lamp_of_group("daylight") + lamp_of_group("butter lamps") + lamp_of_group("daylight") +
            "[[lamp]]\nkind = \"point\"\nposition_m = [0, 1, 0]\nintensity_cd = [1, 1, 1]\n");
  ASSERT_TRUE(package) << package.error().message();
  EXPECT_EQ(package->lamp_groups, (std::vector<std::string>{"daylight", "butter lamps"}));
  ASSERT_EQ(package->lamps.size(), 4u);
  EXPECT_EQ(package->lamps[0].group, 1u);
  EXPECT_EQ(package->lamps[1].group, 2u);
  EXPECT_EQ(package->lamps[2].group, 1u);
  EXPECT_EQ(package->lamps[3].group, 0u);
}

TEST_F(ScenePackageTest, an_eighth_group_of_lamps_and_a_name_without_letters_are_refused) {
  std::string text = kMinimalPackage;
  for (int group = 1; group <= 7; ++group) text += lamp_of_group(fmt::format("group {}", group));
  EXPECT_TRUE(parse(text));
  EXPECT_THAT(complaint(text + lamp_of_group("one more")), HasSubstr("is the 8th group"));
  EXPECT_THAT(complaint(kMinimalPackage + lamp_of_group("")), HasSubstr("1 to 64 bytes"));
}

TEST_F(ScenePackageTest, mistakes_in_flat_lamps_name_their_remedy) {
  const std::string lamp = kMinimalPackage + "[[lamp]]\nposition_m = [0,0,0]\n";
  EXPECT_THAT(complaint(lamp + "kind = 'rectangle'\nluminance_nits = [1,1,1]\n"), HasSubstr("size_m: is missing"));
  EXPECT_THAT(complaint(lamp + "kind = 'disk'\nluminance_nits = [1,1,1]\n"), HasSubstr("radius_m: is missing"));
  EXPECT_THAT(complaint(lamp + "kind = 'disk'\nradius_m = 1\n"), HasSubstr("luminance_nits: is missing"));
  EXPECT_THAT(complaint(lamp + "kind = 'disk'\nradius_m = 1\nflux_lm = [1,1,1]\nluminance_nits = [1,1,1]\n"),
              HasSubstr("keep one of them"));
  EXPECT_THAT(complaint(lamp + "kind = 'disk'\nradius_m = 0\nluminance_nits = [1,1,1]\n"), HasSubstr("radius_m"));
  EXPECT_THAT(complaint(lamp + "kind = 'disk'\nradius_m = 1\nluminance_nits = [1,1,1]\nsize_m = [1,1]\n"),
              HasSubstr("lamp[0].size_m"));
  EXPECT_THAT(complaint(lamp + "kind = 'point'\nintensity_cd = [1,1,1]\nvisible = true\n"),
              HasSubstr("give radius_m as well"));
}

TEST_F(ScenePackageTest, rotations_are_applied_about_x_then_y_then_z) {
  const auto package = parse(kMinimalPackage + "rotation_deg = [90, 90, 0]\nscale = 2\nposition_m = [1, 0, 0]\n");
  ASSERT_TRUE(package.has_value());
  // y goes to z by the rotation about x, and z to x by the rotation about y.
  const Eigen::Vector3d p = package->geometry[0].T_scene_part[0] * Eigen::Vector3d(0, 1, 0);
  EXPECT_LT((p - Eigen::Vector3d(3, 0, 0)).norm(), 1e-12);
}

TEST_F(ScenePackageTest, instances_are_rotated_to_the_right_and_placed) {
  const auto package = parse(kMinimalPackage +
                             "scale = 2\n[[geometry.instance]]\nposition_m = [0, 0, 5]\nheading_deg = 90\n"
                             "[[geometry.instance]]\nscale = 3\n");
  ASSERT_TRUE(package.has_value()) << package.error().message();
  ASSERT_EQ(package->geometry[0].T_scene_part.size(), 2u);
  // The direction -z becomes +x.
  const Eigen::Vector3d p = package->geometry[0].T_scene_part[0] * Eigen::Vector3d(0, 0, -1);
  EXPECT_LT((p - Eigen::Vector3d(2, 0, 5)).norm(), 1e-12);
  EXPECT_LT((package->geometry[0].T_scene_part[1] * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(6, 0, 0)).norm(), 1e-12);
}

TEST_F(ScenePackageTest, files_outside_the_folder_are_refused) {
  std::filesystem::create_symlink("/etc/passwd", folder_ / "link.ply");
  for (const char* const file : {"../a.ply", "/etc/passwd", "in/../../x", "link.ply", ""}) {
    EXPECT_THAT(complaint("title = 'x'\n[[geometry]]\nfile = '" + std::string(file) + "'\n"),
                testing::AllOf(StartsWith("scene.toml:3: "), HasSubstr("not inside the package")))
        << file;
  }
  EXPECT_THAT(complaint("title = 'x'\n[[geometry]]\nfile = 'gone.ply'\n"), HasSubstr("not a file of the package"));
  EXPECT_EQ(complaint("title = 'x'\n[[geometry]]\nfile = 'in/../a.ply'\n"), "");
}

TEST_F(ScenePackageTest, mistakes_name_their_line) {
  EXPECT_THAT(complaint("title = 'x'\n"), HasSubstr("at least one [[geometry]]"));
  EXPECT_THAT(complaint(kMinimalPackage.substr(kMinimalPackage.find('['))), HasSubstr("title: is missing"));
  EXPECT_THAT(complaint(kMinimalPackage + "unit_mm = 1\n"), HasSubstr("write 'unit_m', in that unit"));
  EXPECT_THAT(complaint(kMinimalPackage + "up = 'x'\n"), HasSubstr("must be one of: y, z"));
  EXPECT_THAT(complaint(kMinimalPackage + "scale = 0\n"), StartsWith("scene.toml:4: geometry[0].scale"));
  EXPECT_THAT(complaint(kMinimalPackage + "[visitor]\nwalkable_m = [[0,0],[1,1]]\n"), HasSubstr("corners of an area"));
  EXPECT_THAT(complaint(kMinimalPackage + "[visitor]\nwalkable_m = [[0,0],[1,1],[2,2]]\n"),
              HasSubstr("corners of an area"));
  EXPECT_THAT(complaint(kMinimalPackage + "[[lamp]]\nkind = 'point'\nposition_m = [0,0,0]\n"),
              HasSubstr("intensity_cd: is missing"));
  EXPECT_THAT(
      complaint(kMinimalPackage + "[[lamp]]\nkind = 'directional'\nintensity_lux = [1,1,1]\nintensity_cd = [1,1,1]\n"),
      HasSubstr("lamp[0].intensity_cd"));
  EXPECT_THAT(complaint(kMinimalPackage + "[[lamp]]\nkind = 'spot'\nposition_m = [0,0,0]\nintensity_cd = [1,1,1]\n"
                                          "direction = [0,0,0]\n"),
              HasSubstr("has no length"));
  EXPECT_THAT(complaint(kMinimalPackage + "[[lamp]]\nkind = 'spot'\nposition_m = [0,0,0]\nintensity_cd = [1,1,1]\n"
                                          "inner_cone_deg = 50\n"),
              HasSubstr("must be below outer_cone_deg"));
  EXPECT_THAT(
      complaint(kMinimalPackage + "[visitor]\nwalkable_m = [[0,0],[9,0],[9,9]]\n[start]\neye_m = [0, 1.6, 5]\n"),
      HasSubstr("outside of walkable_m"));
  EXPECT_THAT(complaint(kMinimalPackage + "[visitor]\nwalkable_m = [[0,0],[9,0],[9,9]]\n"),
              HasSubstr("give [start] eye_m"));
}

TEST_F(ScenePackageTest, an_environment_is_a_file_of_the_package_with_strength_and_rotation) {
  std::ofstream(folder_ / "in" / "x.hdr") << "hdr";
  const auto package =
      parse(kMinimalPackage + "[environment]\nfile = 'in/x.hdr'\nstrength = 2.5\nrotation_deg = -90\n");
  ASSERT_TRUE(package.has_value()) << package.error().message();
  ASSERT_TRUE(package->environment.has_value());
  EXPECT_EQ(package->environment->file.filename(), "x.hdr");
  EXPECT_EQ(package->environment->strength, 2.5f);
  EXPECT_NEAR(package->environment->rotation_rad, -0.5 * std::numbers::pi, 1e-6);
  const auto plain = parse(kMinimalPackage + "[environment]\nfile = 'in/x.hdr'\n");
  ASSERT_TRUE(plain.has_value() && plain->environment);
  EXPECT_EQ(plain->environment->strength, 1.0f);
  EXPECT_EQ(plain->environment->rotation_rad, 0.0f);
}

TEST_F(ScenePackageTest, an_environment_outside_the_package_missing_or_beside_a_sky_is_refused) {
  EXPECT_THAT(complaint(kMinimalPackage + "[environment]\nfile = '/etc/passwd'\n"), HasSubstr("inside the package"));
  EXPECT_THAT(complaint(kMinimalPackage + "[environment]\nfile = 'none.hdr'\n"),
              HasSubstr("not a file of the package"));
  EXPECT_THAT(complaint(kMinimalPackage + "[environment]\nstrength = 2\n"), HasSubstr("file"));
  EXPECT_THAT(complaint(kMinimalPackage + "[environment]\nfile = 'a.ply'\nstrength = -1\n"), HasSubstr("strength"));
  EXPECT_THAT(complaint(kMinimalPackage + "[environment]\nfile = 'a.ply'\n[sky]\nzenith = [1, 1, 1]\n"),
              HasSubstr("[sky]"));
}

}  // namespace
}  // namespace cyclorama::scene
