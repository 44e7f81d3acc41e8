// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/exposure.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama::structured_light {
namespace {

/// A wall whose light falls off to a tenth, with some ambient light and perhaps a reflection that saturates.
ExposureSample photograph(double radiance_per_s, ExposureTime exposure, double ambient_share = 0.05) {
  Photo white(50, 40);
  Photo black(50, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) {
      const double light = radiance_per_s * exposure.count() * (0.1 + 0.9 * x / 49.0);
      const double ambient = ambient_share * radiance_per_s * exposure.count();
      *white.at(x, y) = static_cast<float>(std::min(1.0, light + ambient));
      *black.at(x, y) = static_cast<float>(std::min(1.0, ambient));
    }
  }
  return exposure_sample(exposure, white, black);
}

TEST(Exposure, is_found_in_a_few_photographs_for_any_brightness) {
  const ExposureLimits limits{.shortest = ExposureTime(1e-4),
                              .longest = ExposureTime(0.25),
                              .preferred_max = ExposureTime(0.25),
                              .projector_period = ExposureTime(0.0)};
  for (double radiance = 4.0; radiance < 8000.0; radiance *= 1.37) {
    std::vector<ExposureSample> samples;
    int photographs = 0;
    for (;; ++photographs) {
      ASSERT_LT(photographs, 9) << radiance;
      const auto advice = next_exposure(samples, limits);
      ASSERT_TRUE(advice.has_value()) << radiance << ": " << advice.error().message();
      EXPECT_GE(advice->exposure, limits.shortest);
      EXPECT_LE(advice->exposure, limits.longest);
      if (advice->is_good) break;
      samples.push_back(photograph(radiance, advice->exposure));
    }
    EXPECT_GE(samples.back().bright, 0.6) << radiance;
    EXPECT_LE(samples.back().bright, 0.9) << radiance;
  }
}

TEST(Exposure, consists_of_whole_projector_periods_if_possible) {
  const ExposureLimits limits{
      .shortest = ExposureTime(1e-3), .longest = ExposureTime(0.3), .projector_period = ExposureTime(1.0 / 60.0)};
  for (double radiance = 4.0; radiance < 500.0; radiance *= 1.7) {
    std::vector<ExposureSample> samples;
    for (int i = 0; i < 12; ++i) {
      const auto advice = next_exposure(samples, limits);
      ASSERT_TRUE(advice.has_value()) << radiance << ": " << advice.error().message();
      const double periods = advice->exposure / limits.projector_period;
      if (periods >= 1.0) {
        EXPECT_NEAR(periods, std::round(periods), 1e-6);
      }
      if (advice->is_good) {
        EXPECT_LE(samples.back().bright, 0.9);
        break;
      }
      ASSERT_LT(i, 11) << radiance;
      samples.push_back(photograph(radiance, advice->exposure));
    }
  }
}

TEST(Exposure, is_no_longer_than_necessary_for_a_dim_wall) {
  for (const double period : {0.0, 1.0 / 60.0}) {
    const ExposureLimits limits{.projector_period = ExposureTime(period)};
    double before = 1.0;
    for (double radiance = 1.3; radiance < 60.0; radiance *= 1.13) {
      std::vector<ExposureSample> samples;
      for (int i = 0;; ++i) {
        ASSERT_LT(i, 9) << radiance;
        const auto advice = next_exposure(samples, limits);
        ASSERT_TRUE(advice.has_value()) << radiance << ": " << advice.error().message();
        if (advice->is_good) break;
        samples.push_back(photograph(radiance, advice->exposure));
      }
      const ExposureSample& good = samples.back();
      EXPECT_LE(good.bright, 0.9) << radiance;
      EXPECT_GE(good.bright, 0.28) << radiance;
      // Exposures longer than preferred only as far as the picture is dim; shorter ones are bright, to within one
      // period of the projector.
      if (good.exposure > limits.preferred_max + ExposureTime(period)) {
        EXPECT_LE(good.bright, 0.45) << radiance;
      }
      if (good.exposure < limits.preferred_max - 2.0 * ExposureTime(period)) {
        EXPECT_GE(good.bright, period > 0.0 ? 0.38 : 0.6) << radiance;
      }
      EXPECT_LE(good.exposure.count(), 1.6 * before) << radiance;
      before = good.exposure.count();
    }
  }
}

TEST(Exposure, refuses_an_unreachable_exposure_with_a_remedy) {
  const ExposureLimits limits;
  const auto refused = [&limits](double radiance) {
    std::vector<ExposureSample> samples;
    for (int i = 0; i < 20; ++i) {
      const auto advice = next_exposure(samples, limits);
      if (!advice) return advice.error().message();
      if (advice->is_good) return std::string("good");
      samples.push_back(photograph(radiance, advice->exposure));
    }
    return std::string("never ends");
  };
  EXPECT_THAT(refused(1e6), testing::HasSubstr("close the iris"));
  EXPECT_THAT(refused(0.01), testing::HasSubstr("open the iris"));
  EXPECT_THAT(refused(0.0), testing::HasSubstr("open the iris"));
}

TEST(Exposure, refuses_invalid_limits) {
  EXPECT_FALSE(next_exposure({}, {.shortest = ExposureTime(0.0)}).has_value());
  EXPECT_FALSE(next_exposure({}, {.shortest = ExposureTime(1.0), .longest = ExposureTime(0.5)}).has_value());
  EXPECT_FALSE(next_exposure({}, {.longest = ExposureTime(std::numeric_limits<double>::infinity())}).has_value());
  const ExposureSample nowhere{.exposure = ExposureTime(std::nan(""))};
  EXPECT_FALSE(next_exposure({&nowhere, 1}, {}).has_value());
}

}  // namespace
}  // namespace cyclorama::structured_light
