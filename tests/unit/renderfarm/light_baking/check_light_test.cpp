// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/check_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderfarm/light_baking/visible_triangles.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

scene::Scene lit_box() {
  scene::Scene scene = box_scene(0.6f, 8);
  scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.2;
  scene.exposure = 0.5;
  scene.info.walkable = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  return scene;
}

TEST(CheckLight, finds_good_light_good_and_says_so_in_the_store) {
  const auto renderer = built(lit_box());
  BakeSettings settings = quick();
  settings.check_eyes = 4;
  const BakedLight light = baked(*renderer, settings);
  const light::LightCheck& check = light.store->check;
  EXPECT_EQ(check.eyes, 4u);
  EXPECT_LT(check.block_relmse.p50, 1e-3f);
  EXPECT_LE(check.relmse.p50, check.relmse.p99);
  EXPECT_LT(std::abs(check.bias), 0.03f);
  EXPECT_FALSE(check.loses_to_paths());
  EXPECT_GT(light.check_cpu_seconds, 0.0);
  EXPECT_EQ(renderer->light(), light.store.get());
  EXPECT_THAT(light::description_of(*light.store), testing::HasSubstr("4 held-out eyes"));
}

TEST(CheckLight, finds_light_that_is_too_bright_bad_and_says_that_paths_are_better) {
  const auto renderer = built(lit_box());
  const BakedLight light = baked(*renderer);
  EXPECT_THAT(light::description_of(*light.store), testing::HasSubstr("not compared"));
  const auto wrong = std::make_shared<light::LightStore>(*light.store);
  wrong->unit *= 8.0f;
  ASSERT_TRUE(renderer->set_light(wrong, "wrong"));
  CheckSettings settings;
  settings.eyes = 2;
  const auto checked = check_light(*renderer, settings, nullptr, nullptr);
  ASSERT_TRUE(checked);
  EXPECT_GT(checked->check.bias, 3.0f);
  EXPECT_TRUE(checked->check.loses_to_paths());
  wrong->check = checked->check;
  EXPECT_THAT(light::description_of(*wrong), testing::HasSubstr("does not pay"));
}

TEST(CheckLight, can_be_cancelled) {
  const auto renderer = built(lit_box());
  baked(*renderer);
  const auto checked = check_light(*renderer, CheckSettings{}, nullptr, [] { return true; });
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code(), ErrorCode::kUnavailable);
}

TEST(CheckLight, has_eyes_that_the_baker_has_not) {
  const scene::SceneInfo info = lit_box().info;
  const std::vector<Eigen::Vector3d> known = walkable_eyes(info, 64, BakeSettings{}.seed);
  const std::vector<Eigen::Vector3d> held_out = held_out_eyes(info, 32);
  ASSERT_EQ(held_out.size(), 32u);
  for (const Eigen::Vector3d& eye : held_out) {
    for (const Eigen::Vector3d& other : known) EXPECT_GT((eye - other).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
