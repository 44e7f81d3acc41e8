// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "renderfarm/light/scene_key.h"
#include "tests/data_sets/scene_folder.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::light {
namespace {

using testing::HasSubstr;

LightStore example() {
  LightStore store;
  store.scene = {1, 2};
  store.settings = "made by hand";
  store.unit = 0.25f;
  store.check.eyes = 32;
  store.check.relmse = {1e-4f, 2e-4f, 3e-4f};
  store.check.worst_eye = {1.0f, 2.0f, 3.0f};
  store.surfaces.resize(2);
  store.surfaces[0].sides[0].base = {1, 2, 3, 4};
  store.surfaces[0].sides[0].grids = {TriangleGrid::kBase, TriangleGrid::code(1, 0), TriangleGrid::kTraced};
  store.surfaces[0].sides[0].samples = {7, 8, 9};
  store.surfaces[1].base_per_triangle = true;
  store.surfaces[0].sides[0].base_errors = {10, 20, 30, 40};
  store.surfaces[0].sides[0].sample_errors = {0, 128, 255};
  store.surfaces[1].sides[1].base = {5};
  store.surfaces[1].sides[1].base_errors = {50};
  LightStore& group = store.groups.emplace_back();
  group.unit = 0.5f;
  group.surfaces.resize(2);
  group.surfaces[0].sides[0].base = {6, 7, 8, 9};
  group.surfaces[0].sides[0].base_errors = {60, 70, 80, 90};
  return store;
}

std::string refusal(std::vector<std::byte> bytes) {
  const auto store = parse_light_file(bytes, "light.store");
  return store ? "accepted" : store.error().message();
}

TEST(LightFile, survives_a_round_trip) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / kLightFileName;
  ASSERT_TRUE(write_light_file(path, example()));
  const auto again = read_light_file(path);
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(light_file_bytes(*again), light_file_bytes(example()));
  EXPECT_EQ(again->settings, "made by hand");
  EXPECT_EQ(again->check, example().check);
  EXPECT_EQ(again->surfaces[0].sides[0].base_errors, example().surfaces[0].sides[0].base_errors);
  EXPECT_EQ(again->surfaces[0].sides[0].sample_errors, example().surfaces[0].sides[0].sample_errors);
  EXPECT_EQ(again->surfaces[0].sides[0].samples, example().surfaces[0].sides[0].samples);
  ASSERT_EQ(again->groups.size(), 1u);
  EXPECT_EQ(again->groups[0].unit, 0.5f);
  EXPECT_EQ(again->groups[0].surfaces[0].sides[0].base, example().groups[0].surfaces[0].sides[0].base);
}

TEST(LightFile, refuses_every_truncation_and_every_flipped_byte_with_a_remedy) {
  const std::vector<std::byte> bytes = light_file_bytes(example());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::string shorter = refusal({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(i)});
    EXPECT_THAT(shorter, HasSubstr("cyclorama-render light"));
    std::vector<std::byte> flipped = bytes;
    flipped[i] ^= std::byte{0x10};
    EXPECT_THAT(refusal(flipped), HasSubstr("light.store")) << i;
  }
}

TEST(LightFile, names_the_version_it_cannot_read) {
  std::vector<std::byte> bytes = light_file_bytes(example());
  bytes[8] = std::byte{99};
  EXPECT_THAT(refusal(bytes), HasSubstr("version 99"));
}

TEST(LightFile, refuses_samples_outside_the_file) {
  LightStore store = example();
  store.surfaces[0].sides[0].grids[1] = TriangleGrid::code(2, 0);  // Six samples, of which there are three.
  EXPECT_THAT(refusal(light_file_bytes(store)), HasSubstr("outside"));
}

TEST(LightFile, fits_its_own_scene_alone) {
  const std::vector<PlacementSize> sizes = {{4, 3}, {9, 1}};
  EXPECT_TRUE(check_fits(example(), {1, 2}, sizes, "light.store"));
  EXPECT_THAT(check_fits(example(), {1, 3}, sizes, "light.store").error().message(), HasSubstr("another scene"));
  EXPECT_FALSE(check_fits(example(), {1, 2}, {{4, 3}}, "light.store"));
  EXPECT_FALSE(check_fits(example(), {1, 2}, {{5, 3}, {9, 1}}, "light.store"));
  EXPECT_FALSE(check_fits(example(), {1, 2}, {{4, 4}, {9, 1}}, "light.store"));
}

TEST(SceneKey, changes_with_whatever_changes_light_and_with_nothing_else) {
  const auto base = [] {
    scene::Scene scene = scene_of(square_mesh(2.0f));
    scene.model.lights = {point_light({0, 2, 0}, 10.0f)};
    return scene;
  };
  const SceneKey key = key_of(base());
  EXPECT_EQ(key, key_of(base()));
  const auto changed = [&](auto change) {
    scene::Scene scene = base();
    change(scene);
    return !(key_of(scene) == key);
  };
  EXPECT_TRUE(changed([](scene::Scene& s) { s.model.meshes[0].positions[0][1] = 1e-6f; }));
  EXPECT_TRUE(changed([](scene::Scene& s) { s.model.materials[0].base_colour.x() = 0.6f; }));
  EXPECT_TRUE(changed([](scene::Scene& s) { s.model.lights[0].intensity.x() = 11.0f; }));
  EXPECT_TRUE(changed([](scene::Scene& s) { s.sky.zenith.x() = 0.1f; }));
  EXPECT_TRUE(changed([](scene::Scene& s) { s.bounces = 2; }));
  EXPECT_TRUE(changed([](scene::Scene& s) { s.model.instances[0].T_model_mesh.translation().x() = 1.0; }));
  EXPECT_FALSE(changed([](scene::Scene& s) { s.info.title = "another"; }));
  EXPECT_FALSE(changed([](scene::Scene& s) { s.exposure = 2.0; }));
}

}  // namespace
}  // namespace cyclorama::light
