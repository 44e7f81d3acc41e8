// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "renderfarm/scene/area.h"
#include "renderfarm/scene/assemble.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 0 2\nf 1 2 3\n";

class SceneFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("scene_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  Result<Scene> load(const std::string& name) const {
    Result<Scene> scene = load_scene(folder_ / name, {}, nullptr);
    if (scene) {
      EXPECT_EQ(broken_promise(scene->model), "");
    }
    return scene;
  }
  std::string complaint(const std::string& name) const {
    const auto scene = load(name);
    return scene ? "" : scene.error().message();
  }
  std::filesystem::path folder_;
};

TEST_F(SceneFolder, a_package_is_in_metres_with_y_up_and_stores_its_geometry_once) {
  write("a.obj", kObj);
  write("scene.toml",
        "title = 'x'\nunit_m = 0.5\nup = 'z'\n[[geometry]]\nfile = 'a.obj'\n[[geometry.instance]]\n"
        "position_m = [10, 0, 0]\n[[geometry.instance]]\nposition_m = [20, 0, 0]\n");
  const auto scene = load("");
  ASSERT_TRUE(scene.has_value()) << scene.error().message();
  EXPECT_EQ(scene->triangles_stored(), 1u);
  EXPECT_EQ(scene->triangles_seen(), 2u);
  // Two units up along z are one metre up along y.
  EXPECT_LT((scene->bounds.min() - Eigen::Vector3d(10, 0, 0)).norm(), 1e-9);
  EXPECT_LT((scene->bounds.max() - Eigen::Vector3d(20.5, 1, 0)).norm(), 1e-9);
  EXPECT_GT(scene->memory_bytes(), 3u * 12u);
  EXPECT_TRUE(load("scene.toml").has_value()) << "the file stands for its folder";
}

TEST_F(SceneFolder, several_files_keep_their_materials) {
  write("a.mtl", "newmtl red\nKd 1 0 0\n");
  write("b.mtl", "newmtl blue\nKd 0 0 1\n");
  write("a.obj", "mtllib a.mtl\nusemtl red\n" + kObj);
  write("b.obj", "mtllib b.mtl\nusemtl blue\n" + kObj);
  write("scene.toml",
        "title = 'x'\n[[geometry]]\nfile = 'a.obj'\n[[geometry]]\nfile = 'b.obj'\nposition_m = [3, 0, 0]\n");
  const auto scene = load("");
  ASSERT_TRUE(scene.has_value()) << scene.error().message();
  ASSERT_EQ(scene->model.meshes.size(), 2u);
  EXPECT_EQ(scene->model.materials[static_cast<std::size_t>(scene->model.meshes[1].material)].name, "blue");
}

TEST_F(SceneFolder, settings_of_a_package_are_kept_and_missing_ones_derived) {
  write("a.obj", kObj);
  write("scene.toml",
        "title = 'x'\ncredits = 'me'\nexposure = 3\n[start]\neye_m = [1, 2, 3]\nheading_deg = 90\n"
        "[tone]\ncurve = 'linear'\n[sky]\n"
        "zenith = [1, 1, 1]\n[[geometry]]\nfile = 'a.obj'\n");
  const auto scene = load("");
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->info.credits, "me");
  EXPECT_EQ(scene->exposure, 3.0);
  EXPECT_EQ(scene->tone, ToneCurve::kLinear);
  EXPECT_EQ(scene->info.start_eye, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(scene->sky.zenith.x(), 1.0f);
  EXPECT_TRUE(scene->eye_lamp.isZero()) << "it has its own light";
  EXPECT_GE(scene->info.walkable.size(), 3u);
}

TEST_F(SceneFolder, errors_name_the_file_and_the_remedy) {
  EXPECT_THAT(complaint("gone.ply"), HasSubstr("gone.ply"));
  EXPECT_EQ(load("gone.ply").error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(load("").error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(complaint(""), HasSubstr("no scene.toml"));
  write("a.txt", "hello");
  EXPECT_THAT(complaint("a.txt"), HasSubstr(".glb, .gltf, .ply, .obj, .las, .e57 or .spz"));
  write("empty.obj", "");
  EXPECT_THAT(complaint("empty.obj"), HasSubstr("is empty"));
  write("a.obj", "v 0 0 0\nf 1 1 7\n");
  write("scene.toml", "title = 'x'\n[[geometry]]\nfile = 'a.obj'\n");
  EXPECT_THAT(complaint(""), testing::AllOf(HasSubstr("a.obj"), HasSubstr("line 2")));
  write("scene.toml", "title = 'x'\n[[geometry]]\nfile = 'scene.toml'\n");
  EXPECT_FALSE(load("").has_value()) << "a package in a package";
}

TEST_F(SceneFolder, the_format_is_detected_by_content_before_the_name) {
  write("a.obj",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_TRUE(load("a.obj").has_value());
  write("B.OBJ", kObj);
  EXPECT_TRUE(load("B.OBJ").has_value());
}

TEST_F(SceneFolder, a_file_of_thousands_of_units_is_taken_as_millimetres_with_a_note) {
  write("a.obj", "v 500000 0 0\nv 504000 0 0\nv 500000 3000 6000\nf 1 2 3\n");
  const auto scene = load("a.obj");
  ASSERT_TRUE(scene.has_value());
  EXPECT_NEAR(scene->bounds.sizes().z(), 6.0, 1e-6);
  EXPECT_THAT(scene->model.notes, Contains(HasSubstr("taken as millimetres")));
}

TEST_F(SceneFolder, progress_rises_to_one) {
  write("a.obj", kObj);
  double last = 0.0;
  const auto scene = load_scene(folder_ / "a.obj", {}, [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  });
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(last, 1.0);
}

TEST(Assemble, lamps_of_a_file_in_millimetres_keep_their_appearance) {
  Model part;
  part.materials.emplace_back();
  Light lamp;
  lamp.position = {1000, 0, 0};
  lamp.intensity.setConstant(1e6f);
  lamp.range_m = 5000.0;
  part.lights.push_back(lamp);
  Model whole;
  add_part(part, 0.001, {T_part_file(0.001, false)}, &whole);
  EXPECT_NEAR(whole.lights[0].position.x(), 1.0, 1e-9);
  EXPECT_NEAR(whole.lights[0].intensity.x(), 1.0, 1e-6);
  EXPECT_NEAR(whole.lights[0].range_m, 5.0, 1e-9);
}

TEST(Assemble, a_lamp_in_a_globe_shines_from_outside_the_globe) {
  Model model;
  model.materials.resize(1);
  model.materials[0].emissive.setOnes();
  Mesh globe;
  globe.positions = {{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, {0.1f, -0.1f, 0.1f}};
  globe.triangles = {{0, 1, 2}};
  model.meshes.push_back(globe);
  model.instances.push_back({0, Eigen::Affine3d(Eigen::Translation3d(5, 0, 0))});
  Light inside;
  inside.position = {5, 0, 0};
  Light outside;
  outside.position = {6, 0, 0};
  model.lights = {inside, outside};
  free_lamps(&model);
  EXPECT_GT(model.lights[0].radius_m, std::sqrt(0.03));
  EXPECT_EQ(model.lights[1].radius_m, 0.0);
}

TEST(Scenes, cameras_of_a_file_become_its_stops_and_its_copyright_the_credits) {
  CYCLORAMA_SHARED_DATA(file, "scenes/grotto_thousand_buddhas.glb");
  const auto scene = load_scene(file, {}, nullptr);
  ASSERT_TRUE(scene.has_value()) << scene.error().message();
  ASSERT_EQ(scene->info.stops.size(), 6u);
  EXPECT_EQ(scene->info.stops[0].title, "tour_stop_0");
  EXPECT_EQ(scene->info.start_eye, scene->info.stops[0].eye);
  EXPECT_THAT(scene->info.credits, HasSubstr("CC BY 4.0"));
  // The stops lie along the cave, in direction +z: heading 180 degrees, approximately.
  for (const SceneTourStop& stop : scene->info.stops) EXPECT_LT(std::cos(stop.heading_rad), -0.9);
}

TEST(Scenes, every_real_scene_and_relic_loads_with_an_eye_inside_it) {
  for (const char* const folder_name : {"scenes", "relics"}) {
    CYCLORAMA_SHARED_DATA(folder, folder_name);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".glb" && extension != ".gltf" && extension != ".ply") continue;
      const auto scene = load_scene(entry.path(), {}, nullptr);
      ASSERT_TRUE(scene.has_value()) << scene.error().message();
      EXPECT_EQ(broken_promise(scene->model), "") << entry.path();
      EXPECT_GT(scene->triangles_stored(), 1000u);
      EXPECT_GE(scene->info.walkable.size(), 3u);
      EXPECT_TRUE(scene->info.start_eye.allFinite());
      EXPECT_TRUE(is_inside(scene->info.walkable, {scene->info.start_eye.x(), scene->info.start_eye.z()}));
      EXPECT_LT(scene->bounds.sizes().maxCoeff(), 100.0) << "in metres";
      const bool is_site = std::string(folder_name) == "scenes";
      EXPECT_EQ(scene->bounds.contains(scene->info.start_eye), is_site) << entry.path();
    }
  }
}

}  // namespace
}  // namespace cyclorama::scene
