// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/scene_need.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::tools {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string what(const scene::Scene& scene, const std::string& name) {
  for (const NamedNeed& need : named_needs(scene)) {
    if (need.name == name) return need.what;
  }
  ADD_FAILURE() << "nothing is named " << name;
  return "";
}

std::vector<std::string> found(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const NamedNeed& need : named_needs(scene)) {
    if (!need.what.empty()) names.push_back(need.name);
  }
  return names;
}

TEST(NamedNeeds, are_only_indirect_light_for_matte_triangles_without_lamps) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  EXPECT_THAT(found(scene), ElementsAre("indirect light"));
  EXPECT_EQ(what(scene, "indirect light"), "4 bounces");
  scene.bounces = 0;
  EXPECT_THAT(found(scene), IsEmpty());
}

TEST(NamedNeeds, name_the_material_and_why) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  scene::Material& material = scene.model.materials[0];
  material.name = "lacquer";
  material.roughness = 0.5f;
  EXPECT_EQ(what(scene, "glossy surfaces"), "1 material: 'lacquer' (dielectric's gloss)");
  material.clearcoat = 1.0f;
  EXPECT_EQ(what(scene, "glossy surfaces"), "");
  EXPECT_EQ(what(scene, "layered surfaces"), "1 material: 'lacquer' (clear coat)");
  material.transmission = 1.0f;
  material.thickness = 0.1f;
  EXPECT_EQ(what(scene, "layered surfaces"), "1 material: 'lacquer' (clear coat, transmission)");
  EXPECT_EQ(what(scene, "volumes"), "1 material: 'lacquer' (clear)");
}

TEST(NamedNeeds, name_three_of_many_materials) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  for (int i = 1; i < 5; ++i) {
    scene.model.materials.push_back(scene.model.materials[0]);
    add_mesh(scene, square_mesh(1.0f, i));
  }
  for (scene::Material& material : scene.model.materials) material.alpha_mode = scene::AlphaMode::kMask;
  EXPECT_THAT(what(scene, "alpha cut-outs"), HasSubstr("5 materials: '', '', '', ..."));
}

TEST(NamedNeeds, leave_out_materials_without_triangles) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  scene.model.materials.emplace_back();
  scene.model.materials[1].emissive.setOnes();
  EXPECT_EQ(what(scene, "emitters"), "");
  add_mesh(scene, square_mesh(1.0f, 1));
  EXPECT_EQ(what(scene, "emitters"), "1 material: ''");
}

TEST(NamedNeeds, distinguish_the_kinds_of_lamps) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  const auto add = [&](scene::LightKind kind, double radius) {
    scene::Light light = point_light({0, 1, 0}, 1.0f);
    light.kind = kind;
    light.radius_m = radius;
    scene.model.lights.push_back(light);
  };
  add(scene::LightKind::kPoint, 0.0);
  add(scene::LightKind::kSpot, 0.1);
  add(scene::LightKind::kDisk, 0.1);
  add(scene::LightKind::kDirectional, 0.1);
  EXPECT_EQ(what(scene, "lamps without size"), "1");
  EXPECT_EQ(what(scene, "lamps with a size"), "2");
  EXPECT_EQ(what(scene, "suns"), "1");
}

TEST(NamedNeeds, require_instancing_for_a_mesh_with_several_placements) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  EXPECT_EQ(what(scene, "instancing"), "");
  scene.model.instances.push_back(scene.model.instances[0]);
  EXPECT_EQ(what(scene, "instancing"), "1 meshes stand 2 times");
}

}  // namespace
}  // namespace cyclorama::tools
