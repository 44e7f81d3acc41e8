// SPDX-License-Identifier: Apache-2.0
/// What the tests of computed light share: quick settings, a box, and the comparison with traced paths.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "renderfarm/light_baking/bake_light.h"
#include "tests/data_sets/light_scenes.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::light_baking {

inline BakeSettings quick() {
  BakeSettings settings;
  settings.eyes = 4;
  settings.rays_per_eye = 1 << 13;
  settings.pixels_per_degree = 2.0;
  settings.check_eyes = 0;
  settings.min_rays = std::int64_t{1} << 18;
  return settings;
}

inline std::unique_ptr<render::Renderer> built(scene::Scene scene) {
  auto renderer = render::Renderer::build(std::move(scene), 2, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

inline BakedLight baked(render::Renderer& renderer, const BakeSettings& settings = quick(), int threads = 2) {
  auto result = bake_light(renderer, settings, threads, nullptr, nullptr);
  EXPECT_TRUE(result.has_value()) << result.error().message();
  return *std::move(result);
}

using Difference = LightDifference;

inline Difference difference(const render::Renderer& renderer, const render::PanoramaView& view,
                             int reference_samples) {
  return light_difference(renderer, view, reference_samples);
}

}  // namespace cyclorama::light_baking
