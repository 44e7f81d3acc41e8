// SPDX-License-Identifier: Apache-2.0
// Distribution of samples, compared with pdf().
#include <gtest/gtest.h>

#include "renderfarm/render/sampler.h"
#include "tests/support/statistics.h"
#include "tests/unit/renderfarm/render/bsdf_cases.h"

namespace cyclorama::render {
namespace {

std::vector<BsdfCase> all_cases() {
  std::vector<BsdfCase> cases = white_cases();
  const std::vector<BsdfCase> tinted = tinted_cases();
  cases.insert(cases.end(), tinted.begin(), tinted.end());
  return cases;
}

/// Samples of mirrors are outside the pdf, which excludes them.
template <typename Scatter>
SamplerCheck check_of(const Scatter& scattering, unsigned seed) {
  const auto sample = [&](const Vec2& u, float choice) -> std::optional<Vec3> {
    const ScatterSample drawn = scattering.sample(u, choice);
    if (!(drawn.pdf > 0.0f)) return std::nullopt;
    return drawn.wi;
  };
  const auto pdf = [&](const Vec3& wi) { return scattering.pdf(wi); };
  return check_sampler(sample, pdf, 1 << 13, seed, 5);
}

TEST(BsdfSampling, samples_follow_the_pdf) {
  const std::vector<BsdfCase> cases = all_cases();
  const double level = sidak(0.01, static_cast<int>(cases.size()));
  unsigned seed = 1;
  for (const BsdfCase& at : cases) {
    // Alternates, such that each kind of material occurs at many roughnesses.
    const double polar = seed % 2 == 0 ? 0.6 : 1.4;
    with_scattering(at, Vec3::UnitZ(), direction(polar, 0.7), [&](const auto& scattering) {
      const SamplerCheck check = check_of(scattering, seed++);
      EXPECT_GT(check.chi_square.p_value, level) << at.name << " seen at " << polar << ": chi-square "
                                                 << check.chi_square.statistic << " of " << check.chi_square.degrees;
      EXPECT_NEAR(check.integral + check.lost, 1.0, 0.02) << at.name << " seen at " << polar;
    });
  }
}

TEST(BsdfSampling, weights_are_the_bsdf_over_the_pdf) {
  constexpr int kSamples = 64;
  const Vec3 normal = Vec3(0.3f, -0.5f, 0.7f).normalized();
  for (const BsdfCase& at : all_cases()) {
    for (const double polar : {0.0, 0.9, 1.5}) {
      with_scattering(at, normal, from_frame_of(normal, direction(polar, 2.0)), [&](const auto& scattering) {
        for (int i = 0; i < kSamples; ++i) {
          const SampleSequence sequence(7, 0, 0, i, kSamples);
          const ScatterSample drawn = scattering.sample(sequence.pair(0), sequence.pair(1).x());
          if (drawn.weight.isZero(0.0f)) continue;
          ASSERT_NEAR(drawn.wi.norm(), 1.0f, 1e-5f) << at.name;
          EXPECT_EQ(drawn.through, drawn.wi.dot(normal) < 0.0f) << at.name;
          if (drawn.pdf == 0.0f) continue;
          // In narrow lobes, rounding of the direction causes errors of several percent.
          const float slack = at.bsdf.alpha < 0.01f ? 0.05f : 2e-3f;
          ASSERT_NEAR(scattering.pdf(drawn.wi) / drawn.pdf, 1.0f, slack) << at.name;
          const Vec3 value = scattering.evaluate(drawn.wi) / scattering.pdf(drawn.wi);
          ASSERT_LE((value - drawn.weight).cwiseAbs().maxCoeff(), slack * std::max(1.0f, value.maxCoeff())) << at.name;
        }
      });
    }
  }
}

TEST(BsdfSampling, has_no_fireflies_on_white_surfaces) {
  constexpr int kSamples = 1 << 10;
  for (const BsdfCase& at : white_cases()) {
    with_scattering(at, Vec3::UnitZ(), direction(1.2, 0.5), [&](const auto& scattering) {
      float max = 0.0f;
      for (int i = 0; i < kSamples; ++i) {
        const SampleSequence sequence(9, 0, 0, i, kSamples);
        max = std::max(max, scattering.sample(sequence.pair(0), sequence.pair(1).x()).weight.maxCoeff());
      }
      EXPECT_LT(max, 8.0f) << at.name;
    });
  }
}

}  // namespace
}  // namespace cyclorama::render
