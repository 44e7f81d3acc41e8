// SPDX-License-Identifier: Apache-2.0
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace cyclorama::render {
namespace {

Vec3 uniform_sphere(const Vec2& u) { return uniform_cap(u, 2.0f); }

double uniform_pdf(const Vec3&) { return 0.25 / std::numbers::pi; }

TEST(ChiSquare, has_the_p_values_of_the_tables) {
  EXPECT_NEAR(chi_square_p_value(3.841458820694124, 1), 0.05, 1e-12);
  EXPECT_NEAR(chi_square_p_value(18.307038053275146, 10), 0.05, 1e-12);
  EXPECT_NEAR(chi_square_p_value(135.80672317102676, 100), 0.01, 1e-12);
  EXPECT_NEAR(chi_square_p_value(2.0, 2), std::exp(-1.0), 1e-14);
  EXPECT_NEAR(chi_square_p_value(60.0, 2), std::exp(-30.0), 1e-25);
  EXPECT_EQ(chi_square_p_value(0.0, 5), 1.0);
  EXPECT_EQ(chi_square_p_value(std::numeric_limits<double>::infinity(), 5), 0.0);
  EXPECT_EQ(chi_square_p_value(std::numeric_limits<double>::quiet_NaN(), 5), 0.0);
}

TEST(ChiSquare, combines_the_levels_of_many_tests) {
  EXPECT_NEAR(1.0 - std::pow(1.0 - sidak(0.01, 250), 250), 0.01, 1e-12);
  EXPECT_NEAR(sidak(0.01, 1), 0.01, 1e-15);
}

TEST(ChiSquare, gives_impossible_counts_probability_zero) {
  EXPECT_EQ(chi_square(std::array{10.0, 1.0}, std::array{11.0, 0.0}).p_value, 0.0);
  EXPECT_GT(chi_square(std::array{10.0, 0.0}, std::array{10.0, 0.0}).p_value, 0.9);
}

TEST(SphereHistogram, has_uniform_p_values_for_the_right_pdf) {
  int low = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const SamplerCheck check = check_sampler([](const Vec2& u, float) { return std::optional(uniform_sphere(u)); },
                                             uniform_pdf, 1 << 13, seed, 5);
    EXPECT_NEAR(check.integral, 1.0, 1e-9);
    if (check.chi_square.p_value < 0.5) ++low;
  }
  EXPECT_NEAR(low, 20, 12);
}

TEST(SphereHistogram, detects_a_pdf_that_is_a_few_percent_wrong) {
  const auto pdf = [](const Vec3& v) { return uniform_pdf(v) * (1.0 + 0.1 * static_cast<double>(v.z())); };
  const auto sample = [](const Vec2& u, float) { return std::optional(uniform_sphere(u)); };
  const SamplerCheck check = check_sampler(sample, pdf);
  EXPECT_NEAR(check.integral, 1.0, 1e-4);
  EXPECT_LT(check.chi_square.p_value, 1e-6);
}

TEST(SphereHistogram, detects_samples_that_are_lost) {
  const auto sample = [](const Vec2& u, float choice) {
    return choice < 0.01f ? std::nullopt : std::optional(uniform_sphere(u));
  };
  EXPECT_LT(check_sampler(sample, uniform_pdf).chi_square.p_value, 1e-6);
  const auto honest = [](const Vec3& v) { return 0.99 * uniform_pdf(v); };
  EXPECT_GT(check_sampler(sample, honest).chi_square.p_value, 1e-3);
}

/// A cap of half a degree, of which a fixed grid would have a single bin.
TEST(SphereHistogram, resolves_narrow_lobes_and_hard_edges) {
  constexpr float kHeight = 4e-5f;
  const Vec3 axis = Vec3(0.3f, -0.5f, 0.8f).normalized();
  const auto sample = [&](const Vec2& u, float) { return std::optional(from_frame_of(axis, uniform_cap(u, kHeight))); };
  const auto pdf = [&](const Vec3& v) {
    const bool inside = 0.5f * (v - axis).squaredNorm() <= kHeight;
    return inside ? 1.0 / (2.0 * std::numbers::pi * static_cast<double>(kHeight)) : 0.0;
  };
  const SamplerCheck check = check_sampler(sample, pdf);
  EXPECT_NEAR(check.integral, 1.0, 0.01);
  EXPECT_GT(check.chi_square.p_value, 1e-3);
  const auto off_centre = [&](const Vec2& u, float) {
    return std::optional(from_frame_of(axis, uniform_cap(Vec2(std::pow(u.x(), 1.1f), u.y()), kHeight)));
  };
  EXPECT_LT(check_sampler(off_centre, pdf).chi_square.p_value, 1e-6);
}

}  // namespace
}  // namespace cyclorama::render
