// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/defect_report.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/file.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::tools {
namespace {

TEST(Repair, is_written_before_the_first_table_and_only_once) {
  const std::string text = "title = \"Bust\"\n\n[[geometry]]\nfile = \"bust.ply\"\nrepair_this = 1\n";
  const std::string repaired = with_repair(text);
  EXPECT_EQ(repaired, "title = \"Bust\"\n\nrepair = true\n[[geometry]]\nfile = \"bust.ply\"\nrepair_this = 1\n");
  EXPECT_EQ(with_repair(repaired), repaired);
  EXPECT_EQ(with_repair("title = \"B\"\n  repair=false # no\n[sky]\n"), "title = \"B\"\nrepair = true\n[sky]\n");
}

TEST(Repair, refuses_a_geometry_file_with_the_remedy) {
  const Status status = save_repair("bust.ply");
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(status.error().message().find("scene.toml"), std::string::npos);
}

TEST(DefectPictures, show_each_of_the_largest_defects) {
  scene::Scene scene = scene_of(sphere_mesh(1.0f, 32));
  scene.sky = {Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones()};
  scene.model.meshes[0].triangles.erase(scene.model.meshes[0].triangles.begin() + 2000);
  const scene::Defects defects = scene::find_defects(scene.model);
  const auto renderer = render::Renderer::build(std::move(scene), 2, nullptr);
  ASSERT_TRUE(renderer.has_value());
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "defect_pictures";
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(draw_defects(**renderer, defects, folder).has_value());
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "holes-1.png"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cyclorama::tools
