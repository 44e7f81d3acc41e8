// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/bsdf.h"

#include <gtest/gtest.h>

#include <random>

#include "renderfarm/render/sampler.h"

namespace cyclorama {
namespace {

Vec3 direction(double polar, double azimuth) {
  return {static_cast<float>(std::sin(polar) * std::cos(azimuth)),
          static_cast<float>(std::sin(polar) * std::sin(azimuth)), static_cast<float>(std::cos(polar))};
}

/// Integral of BSDF times cosine over the hemisphere about +z, by the midpoint rule.
double reflected_part(const Scattering<true>& scattering) {
  constexpr int kPolar = 600;
  constexpr int kAround = 600;
  double sum = 0.0;
  for (int i = 0; i < kPolar; ++i) {
    const double polar = (i + 0.5) * 0.5 * M_PI / kPolar;
    for (int j = 0; j < kAround; ++j) {
      const Vec3 value = scattering.evaluate(direction(polar, (j + 0.5) * 2.0 * M_PI / kAround));
      sum += static_cast<double>(value.x()) * std::sin(polar);
    }
  }
  return sum * (0.5 * M_PI / kPolar) * (2.0 * M_PI / kAround);
}

struct Case {
  float base;
  float metallic;
  float roughness;
  double polar;
};

class GlossTest : public ::testing::TestWithParam<Case> {
 protected:
  Bsdf bsdf_ = make_glossy(Vec3::Constant(GetParam().base), GetParam().metallic, GetParam().roughness);
  Scattering<true> scattering_{bsdf_, Vec3::UnitZ(), direction(GetParam().polar, 0.7)};
};

TEST_P(GlossTest, reflects_no_more_than_it_gets) {
  const double part = reflected_part(scattering_);
  EXPECT_LE(part, 1.002);
  EXPECT_GE(part, 0.0);
}

TEST_P(GlossTest, sampling_agrees_with_the_integral) {
  constexpr int kSamples = 1 << 16;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const SampleSequence sequence(11, 0, 0, i, kSamples);
    Vec3 weight;
    const Vec3 wi = scattering_.sample(sequence.pair(0), sequence.pair(1).x(), &weight);
    ASSERT_NEAR(wi.norm(), 1.0f, 1e-3f);
    ASSERT_TRUE(is_finite(weight));
    ASSERT_GE(weight.minCoeff(), 0.0f);
    sum += static_cast<double>(weight.x());
  }
  EXPECT_NEAR(sum / kSamples, reflected_part(scattering_), 0.01);
}

TEST_P(GlossTest, swapping_light_and_viewer_changes_nothing_but_the_cosine) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> polar(0.05, 1.5);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = direction(polar(random), 4.0 * polar(random));
    const Vec3 b = direction(polar(random), -3.0 * polar(random));
    const float there = Scattering<true>(bsdf_, Vec3::UnitZ(), a).evaluate(b).x() / b.z();
    const float back = Scattering<true>(bsdf_, Vec3::UnitZ(), b).evaluate(a).x() / a.z();
    EXPECT_NEAR(there, back, 1e-3f * std::max(1.0f, there));
  }
}

TEST_P(GlossTest, the_even_light_albedo_is_near_the_integral) {
  EXPECT_NEAR(static_cast<double>(scattering_.albedo().x()), reflected_part(scattering_), 0.15);
}

INSTANTIATE_TEST_SUITE_P(Materials, GlossTest,
                         ::testing::Values(Case{0.5f, 0.0f, 0.3f, 0.2}, Case{0.8f, 1.0f, 0.2f, 0.5},
                                           Case{1.0f, 1.0f, 0.5f, 1.2}, Case{0.9f, 0.0f, 0.9f, 1.3},
                                           Case{0.3f, 0.5f, 0.6f, 0.9}, Case{1.0f, 1.0f, 1.0f, 0.1}));

TEST(Scattering, a_matte_surface_is_exactly_lambert) {
  const Bsdf bsdf = make_matte({0.2f, 0.4f, 0.6f});
  const Scattering<true> scattering(bsdf, Vec3::UnitZ(), direction(0.3, 0.0));
  EXPECT_TRUE(scattering.evaluate(Vec3::UnitZ()).isApprox(bsdf.diffuse / kPi));
  EXPECT_TRUE(scattering.evaluate(-Vec3::UnitZ()).isZero(0.0f));
  EXPECT_EQ(scattering.albedo(), bsdf.diffuse);
  Vec3 weight;
  EXPECT_GT(scattering.sample({0.3f, 0.9f}, 0.5f, &weight).z(), 0.0f);
  EXPECT_EQ(weight, bsdf.diffuse);
}

TEST(Scattering, extremes_give_numbers) {
  for (const float roughness : {0.0f, 1.0f, -1.0f, 5.0f}) {
    for (const float metallic : {0.0f, 1.0f}) {
      for (const float base : {0.0f, 1.0f}) {
        const Bsdf bsdf = make_glossy(Vec3::Constant(base), metallic, roughness);
        for (const Vec3& wo : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0.9999f, 0, 0.0141f)}) {
          const Scattering<true> scattering(bsdf, Vec3::UnitZ(), wo);
          for (const Vec3& wi : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-wo), wo, Vec3(0, 0, -1)}) {
            EXPECT_TRUE(is_finite(scattering.evaluate(wi)));
          }
          for (const Vec2& u : {Vec2(0, 0), Vec2(0.99999994f, 0.99999994f), Vec2(0.5f, 0.0f)}) {
            for (const float choice : {0.0f, 0.5f, 0.99999994f}) {
              Vec3 weight;
              const Vec3 wi = scattering.sample(u, choice, &weight);
              EXPECT_TRUE(is_finite(weight));
              EXPECT_NEAR(wi.norm(), 1.0f, 1e-3f);
            }
          }
          EXPECT_TRUE(is_finite(scattering.albedo()));
        }
      }
    }
  }
}

}  // namespace
}  // namespace cyclorama
