// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/walkable/walkable_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "renderfarm/scene/scene_package.h"

namespace cyclorama::walkable {
namespace {

using testing::HasSubstr;
using testing::Not;

const Eigen::Vector3d kEye(0.5, 1.6, 0.25);

WalkableGround triangle(bool hole) {
  WalkableGround ground;
  ground.outline = {{-3, -3}, {3, -3}, {0.5, 4}};
  if (hole) ground.holes = {{{1, -1}, {1.5, -1}, {1, -0.5}}, {{-1, -1}, {-1.5, -1}, {-1, -0.5}}};
  return ground;
}

/// The file that it names must exist to be read.
class WalkableFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / "walkable_file";
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "a.ply") << "ply\n";
  }
  Result<scene::ScenePackage> read(const std::string& text) {
    return scene::parse_scene_package(text, "scene.toml", folder_);
  }
  std::filesystem::path folder_;
};

constexpr const char* kGeometry = "[[geometry]]\nfile = \"a.ply\"\n";

TEST_F(WalkableFile, adds_the_area_to_a_package_that_has_none) {
  for (const bool hole : {false, true}) {
    const auto text = with_walkable(std::string("title = \"x\"\n") + kGeometry, "scene.toml", triangle(hole), kEye);
    ASSERT_TRUE(text);
    const auto package = read(*text);
    ASSERT_TRUE(package) << package.error().message() << "\n" << *text;
    EXPECT_EQ(package->walkable, triangle(hole).outline);
    EXPECT_EQ(package->walkable_holes, triangle(hole).holes);
    EXPECT_EQ(package->start_eye, kEye);
  }
}

TEST_F(WalkableFile, replaces_an_existing_area_and_keeps_everything_else_even_comments) {
  const std::string before =
      "title = \"\"\"\n[visitor]\nwalkable_m = [[\n\"\"\"  # [start]\n"
      "[start]   # here\neye_m = [0, 1.6, 0]\n"
      "[visitor]\neye_height_m = 1.6 # of a child\nwalkable_m = [[-1, -1], # one ]\n  [1, -1],\n  [0, 2]]\n"
      "walking_scale = 1.5\n"
      "# Pillars\n[[visitor.hole]]\ncorners_m = [[0, 0.5], [0.2, 0.5],\n [0, 0.7]]\n\n"
      "[[visitor.hole]]\ncorners_m = [[0.5, 0], [0.7, 0], [0.5, 0.2]]\n\n# Scans\n" +
      std::string(kGeometry);
  ASSERT_TRUE(read(before)) << read(before).error().message();
  const auto text = with_walkable(before, "scene.toml", triangle(true), kEye);
  ASSERT_TRUE(text);
  const auto package = read(*text);
  ASSERT_TRUE(package) << package.error().message() << "\n" << *text;
  EXPECT_EQ(package->walkable, triangle(true).outline);
  EXPECT_EQ(package->walkable_holes, triangle(true).holes);
  EXPECT_EQ(package->start_eye, Eigen::Vector3d(0, 1.6, 0)) << "it was said";
  EXPECT_EQ(package->walking_scale, 1.5);
  EXPECT_EQ(package->title, read(before)->title);
  EXPECT_THAT(*text, HasSubstr("# of a child"));
  EXPECT_THAT(*text, HasSubstr("# Scans\n[[geometry]]"));
  EXPECT_THAT(*text, Not(HasSubstr("# one")));
  const auto again = with_walkable(*text, "scene.toml", triangle(true), kEye);
  ASSERT_TRUE(again);
  EXPECT_EQ(read(*again)->walkable_holes.size(), 2u) << "twice is once";
}

TEST_F(WalkableFile, refuses_files_that_it_cannot_edit) {
  for (const char* const table :
       {"visitor = { eye_height_m = 1.6 }\n", "visitor.eye_height_m = 1.6\n", "start = { heading_deg = 3 }\n"}) {
    const auto text =
        with_walkable(std::string("title = \"x\"\n") + table + kGeometry, "scene.toml", triangle(false), kEye);
    ASSERT_FALSE(text) << table;
    EXPECT_THAT(text.error().message(), HasSubstr("header"));
  }
}

TEST_F(WalkableFile, names_mistakes) {
  const std::string base = std::string("title = \"x\"\n") + kGeometry + "[start]\neye_m = [0, 1.6, 0]\n[visitor]\n";
  const std::string area = "walkable_m = [[-1, -1], [1, -1], [0, 2]]\n";
  EXPECT_TRUE(read(base + area));
  const auto says = [&](const std::string& text) { return read(text).error().message(); };
  EXPECT_THAT(says(base + area + "[[visitor.hole]]\ncorners_m = [[0, 1], [1, 1]]\n"), HasSubstr("three or more"));
  EXPECT_THAT(says(base + area + "[[visitor.hole]]\ncorner_m = [[0, 1], [1, 1], [1, 0]]\n"), HasSubstr("corners_m"));
  EXPECT_THAT(says(base + area + "[[visitor.hole]]\ncorners_m = [[-0.5, -0.5], [0.5, -0.5], [0, 0.5]]\n"),
              HasSubstr("does not hold the start"));
  EXPECT_THAT(says(base + "[[visitor.hole]]\ncorners_m = [[0, 1], [1, 1], [1, 0]]\n"), HasSubstr("walkable_m as well"));
}

}  // namespace
}  // namespace cyclorama::walkable
