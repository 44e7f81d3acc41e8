// SPDX-License-Identifier: Apache-2.0
// Tests by statistics, region by region, whether stored light is that of traced paths: both are computed several times
// with other random numbers, and their scatter states how far the means may be apart.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 48;
constexpr int kRegionPx = 12;
constexpr int kRuns = 6;
/// Bias that is too small to be seen, a fifth of a code in the middle of the range: part of the regions' light.
constexpr double kUnseenBias = 0.004;
/// Student t with ten degrees of freedom: one of 32 regions exceeds this by chance in three tests of a hundred.
constexpr double kMaxScore = 4.6;

scene::Scene lit_box() {
  scene::Scene scene = box_scene(0.6f, 16);
  scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.2;
  scene.exposure = 0.5;
  return scene;
}

/// Mean of the runs in each region, and the standard error of that mean.
struct Regions {
  std::vector<double> mean;
  std::vector<double> error;
};

template <typename Run>
Regions regions_of(Run run) {
  constexpr std::size_t kColumns = kWidth / kRegionPx;
  constexpr std::size_t kRows = kHeight / kRegionPx;
  const std::size_t count = kColumns * kRows;
  std::vector<double> sum(count, 0.0);
  std::vector<double> squares(count, 0.0);
  for (int n = 0; n < kRuns; ++n) {
    const RadianceImage image = run(n);
    std::vector<double> light(count, 0.0);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const std::size_t row = static_cast<std::size_t>(y) / kRegionPx;
        const std::size_t region = row * kColumns + static_cast<std::size_t>(x) / kRegionPx;
        light[region] += static_cast<double>(image.at(x, y)[1]) / (kRegionPx * kRegionPx);
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      sum[i] += light[i];
      squares[i] += light[i] * light[i];
    }
  }
  Regions regions;
  for (std::size_t i = 0; i < count; ++i) {
    const double mean = sum[i] / kRuns;
    regions.mean.push_back(mean);
    regions.error.push_back(std::sqrt(std::max(0.0, squares[i] / kRuns - mean * mean) / (kRuns - 1)));
  }
  return regions;
}

render::PanoramaView view_of_box() { return view_from({0.3, 0.2, -0.1}, kWidth, kHeight, 1.0, -1.0); }

Regions traced_regions() {
  const auto renderer = built(lit_box());
  return regions_of([&](int run) {
    render::PanoramaView view = view_of_box();
    view.quality.bounces = renderer->scene().bounces;
    view.quality.samples = 64;
    view.seed = 100 + static_cast<std::uint64_t>(run);
    return radiance_of(*renderer, view);
  });
}

/// `share`: factor on the stored light, for the test of the test.
Regions stored_regions(float share) {
  return regions_of([&](int run) {
    const auto renderer = built(lit_box());
    BakeSettings settings = quick();
    settings.seed = 1 + static_cast<std::uint64_t>(run);
    const auto light = std::make_shared<light::LightStore>(*baked(*renderer, settings).store);
    light->unit *= share;
    EXPECT_TRUE(renderer->set_light(light, "the light just computed"));
    render::PanoramaView view = view_of_box();
    view.quality.stored_light = true;
    view.quality.samples = 16;
    return radiance_of(*renderer, view);
  });
}

/// Returns the largest distance between two means beyond the unseen bias, in standard errors.
double max_score(const Regions& stored, const Regions& traced) {
  double most = 0.0;
  for (std::size_t i = 0; i < traced.mean.size(); ++i) {
    const double beyond = std::abs(stored.mean[i] - traced.mean[i]) - kUnseenBias * traced.mean[i];
    most = std::max(most, beyond / std::hypot(stored.error[i], traced.error[i]));
  }
  return most;
}

TEST(LightRegions, differ_from_traced_paths_by_chance_alone) {
  const Regions traced = traced_regions();
  EXPECT_LT(max_score(stored_regions(1.0f), traced), kMaxScore);
  EXPECT_GT(max_score(stored_regions(1.02f), traced), kMaxScore) << "two per cent would be found";
}

}  // namespace
}  // namespace cyclorama::light_baking
