// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/markerless/light_fit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::tracker {
namespace {

std::vector<LogLightSample> samples_of(const LightGain& gain, double somebody_from_x = 2.0) {
  std::vector<LogLightSample> samples;
  for (double y = -1.0; y <= 1.0; y += 0.1) {
    for (double x = -1.0; x <= 1.0; x += 0.1) {
      const double other = x > somebody_from_x ? 0.8 * std::sin(9.0 * x + 7.0 * y) - 0.5 : 0.0;
      samples.push_back({x, y, gain.at(x, y) + other, 1.0});
    }
  }
  return samples;
}

LightGain any_gain() {
  LightGain gain;
  gain.coefficients << 0.5, 0.2, -0.1, -0.2, 0.05, 0.1;
  return gain;
}

TEST(LightFit, recovers_the_surface_of_the_light) {
  const LightGain fitted = fitted_light(samples_of(any_gain()));
  for (const LogLightSample& s : samples_of(any_gain())) EXPECT_NEAR(fitted.at(s.x, s.y), s.log_ratio, 0.01);
}

TEST(LightFit, ignores_a_person_in_a_third_of_the_picture) {
  const LightGain fitted = fitted_light(samples_of(any_gain(), 0.35));
  for (double x = -1.0; x < 0.3; x += 0.1) EXPECT_NEAR(fitted.at(x, 0.2), any_gain().at(x, 0.2), 0.05);
}

TEST(LightFit, reports_no_change_without_samples) {
  EXPECT_TRUE(fitted_light({}).coefficients.isZero());
  std::vector<LogLightSample> masked(100, LogLightSample{0.0, 0.0, 1.0, 0.0});
  EXPECT_TRUE(fitted_light(masked).coefficients.isZero());
  // All samples are at one position: an undetermined surface is flat.
  std::vector<LogLightSample> same(100, LogLightSample{0.5, 0.5, 1.0, 1.0});
  EXPECT_TRUE(fitted_light(same).coefficients.allFinite());
  EXPECT_NEAR(fitted_light(same).at(0.5, 0.5), 1.0, 0.05);
}

}  // namespace
}  // namespace cyclorama::tracker
