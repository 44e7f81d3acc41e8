// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/features/feature_saving.h"

#include <gtest/gtest.h>

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

Result<FeatureReport> measured(scene::Scene scene, int repetitions = 1,
                               const std::function<bool()>& cancelled = nullptr) {
  TRY_ASSIGN(const std::unique_ptr<Renderer> renderer, Renderer::build(std::move(scene), 1, nullptr));
  return measure_features(renderer.get(), view_from({0, 1, 0}, 32, 16, 0.5, -1.0), repetitions, cancelled);
}

TEST(Features, are_measured_level_by_level) {
  for (const int repetitions : {1, 2}) {
    scene::Scene scene = scene_of(square_mesh(4.0f));
    scene.model.lights.push_back(point_light({0, 2, 0}, 1.0f));
    const auto report = measured(std::move(scene), repetitions);
    ASSERT_TRUE(report.has_value());
    EXPECT_GT(report->rays, 32u * 16u);
    EXPECT_GT(report->cost.ns_per_ray, 0.0);
    EXPECT_EQ(report->kernel, SurfaceLevel::kMatte);
    ASSERT_EQ(report->savings.size(), 2u);
    EXPECT_EQ(report->savings.front().kernel, SurfaceLevel::kGlossy);
    EXPECT_EQ(report->savings.back().kernel, SurfaceLevel::kLayered);
    for (const FeatureSaving& saved : report->savings) {
      EXPECT_GT(saved.cost.ns_per_ray, 0.0);
      EXPECT_LT(saved.time_saving, 1.0);
    }
  }
}

TEST(Features, of_a_scene_that_needs_all_save_nothing) {
  scene::Scene scene = scene_of(square_mesh(4.0f));
  scene.model.materials[0].clearcoat = 1.0f;
  const auto report = measured(std::move(scene));
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->kernel, SurfaceLevel::kLayered);
  EXPECT_TRUE(report->savings.empty());
}

TEST(Features, stop_when_cancelled) {
  const auto report = measured(scene_of(square_mesh(4.0f)), 1, [] { return true; });
  ASSERT_FALSE(report.has_value());
  EXPECT_EQ(report.error().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace cyclorama::render
