// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/trade_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace cyclorama::render {
namespace {

TEST(TradePlan, has_valid_settings_without_duplicates) {
  for (const bool quick : {true, false}) {
    const std::vector<PlannedPoint> plan = trade_plan(quick);
    for (std::size_t i = 0; i < plan.size(); ++i) {
      EXPECT_TRUE(validate(plan[i].quality)) << i;
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(plan[i].quality == plan[j].quality) << i << " and " << j;
    }
  }
}

TEST(TradePlan, varies_every_setting) {
  for (const bool quick : {true, false}) {
    std::set<int> samples, bounces, lights, qualities;
    std::set<float> fireflies, adaptive;
    std::set<double> scales;
    std::set<bool> denoised, subsampled;
    for (const PlannedPoint& point : trade_plan(quick)) {
      samples.insert(point.quality.render.samples);
      bounces.insert(point.quality.render.bounces);
      lights.insert(point.quality.render.light_samples);
      fireflies.insert(point.quality.render.firefly_limit);
      adaptive.insert(point.quality.render.adaptive_error);
      scales.insert(point.quality.scale);
      denoised.insert(point.quality.denoise);
      qualities.insert(point.quality.jpeg_quality);
      subsampled.insert(point.quality.subsample_chroma);
    }
    for (const std::size_t values : {samples.size(), bounces.size(), lights.size(), fireflies.size(), adaptive.size(),
                                     scales.size(), denoised.size(), qualities.size(), subsampled.size()}) {
      EXPECT_GE(values, 2u);
    }
  }
}

TEST(TradePlan, a_setting_varied_alone_differs_from_the_base_only_in_that) {
  for (const PlannedPoint& point : trade_plan(false)) {
    PictureQuality quality = point.quality;
    const PictureQuality base = trade_base();
    if (point.knob == "samples") quality.render.samples = base.render.samples;
    if (point.knob == "bounces") quality.render.bounces = base.render.bounces;
    if (point.knob == "scale") quality.scale = base.scale;
    if (point.knob == "jpeg") {
      quality.jpeg_quality = base.jpeg_quality;
      quality.subsample_chroma = base.subsample_chroma;
    }
    if (point.knob == "samples" || point.knob == "bounces" || point.knob == "scale" || point.knob == "jpeg") {
      EXPECT_EQ(quality, base) << point.knob;
    }
  }
}

TEST(TradePlan, quick_is_a_tenth_of_the_work) {
  const auto work = [](bool quick) {
    double sum = 0.0;
    for (const PlannedPoint& point : trade_plan(quick)) {
      sum +=
          point.quality.scale * point.quality.scale * point.quality.render.samples * (2 + point.quality.render.bounces);
    }
    return sum;
  };
  EXPECT_LT(work(true), 0.1 * work(false));
}

}  // namespace
}  // namespace cyclorama::render
