// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/environment_light.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/light_checks.h"
#include "tests/support/statistics.h"

namespace cyclorama::render {
namespace {

std::shared_ptr<scene::EnvironmentMap> map_of(int width, int height, float value) {
  auto map = std::make_shared<scene::EnvironmentMap>();
  map->pixels = RadianceImage(width, height, value);
  return map;
}

std::shared_ptr<scene::EnvironmentMap> noisy_map(int width, int height) {
  auto map = map_of(width, height, 0.0f);
  std::mt19937 random(1);
  for (float& value : map->pixels.data()) {
    value = static_cast<float>(random() % 4 == 0 ? random() % 1000 : 0) * 0.01f;
  }
  map->rotation_rad = 0.7f;
  map->strength = 3.0f;
  return map;
}

void expect_right_pdf(const EnvironmentLight& light, const char* name, const Vec3& n = Vec3::Zero()) {
  const auto sample = [&](const Vec2& u, float) -> std::optional<Vec3> {
    LightSample aim;
    if (!light.sample(n, u, &aim)) return std::nullopt;
    EXPECT_NEAR(light.pdf(n, aim.direction) / aim.pdf, 1.0f, 0.02f) << name;
    return aim.direction;
  };
  const SamplerCheck check = check_sampler(
      sample, [&](const Vec3& d) { return light.pdf(n, d); }, 1 << 14, 3, 6);
  EXPECT_GT(check.chi_square.p_value, 0.002) << name;
  EXPECT_NEAR(check.integral, 1.0, 0.02) << name;
}

TEST(EnvironmentLight, samples_follow_the_pdf) {
  const scene::Sky sky{Eigen::Vector3f(0.4f, 0.5f, 0.8f), Eigen::Vector3f::Constant(0.2f),
                       Eigen::Vector3f::Constant(0.05f)};
  expect_right_pdf(EnvironmentLight(sky, nullptr), "sky");
  expect_right_pdf(EnvironmentLight(sky, nullptr), "sky over a slope", Vec3(0.6f, 0.48f, -0.64f));
  expect_right_pdf(EnvironmentLight({}, map_of(7, 5, 1.0f)), "even map");
  expect_right_pdf(EnvironmentLight({}, noisy_map(9, 6)), "noisy map");
  expect_right_pdf(EnvironmentLight({}, map_of(1, 1, 1.0f)), "one texel");
}

TEST(EnvironmentLight, a_constant_map_has_irradiance_pi) {
  for (const int height : {1, 2, 16, 33}) {
    const EnvironmentLight light({}, map_of(2 * height, height, 1.0f));
    for (const Vec3& n : {Vec3(0, 1, 0), Vec3(0, 0, -1), Vec3(0.6f, -0.8f, 0)}) {
      const auto sample = [&](float, const Vec2& u, LightSample* aim) { return light.sample(n, u, aim); };
      EXPECT_NEAR(sampled_irradiance(sample, n), std::numbers::pi, 0.03) << height;
      EXPECT_GT(light.estimate(n), 1.0f) << height;
      if (height >= 16) {
        EXPECT_NEAR(light.estimate(n), std::numbers::pi, 0.4) << height;
      }
    }
  }
}

TEST(EnvironmentLight, has_its_texels_in_the_right_directions) {
  auto map = map_of(8, 4, 0.0f);
  const auto paint = [&](int x, int y, float value) { map->pixels.at(x, y)[0] = value; };
  for (int y = 1; y < 3; ++y) {
    paint(3, y, 2.0f);  // Ahead, -z.
    paint(4, y, 2.0f);
    paint(5, y, 3.0f);  // To the right, +x.
    paint(6, y, 3.0f);
  }
  EnvironmentLight light({}, map);
  EXPECT_NEAR(light.radiance(-Vec3::UnitZ()).x(), 2.0f, 1e-5f);
  EXPECT_NEAR(light.radiance(Vec3::UnitX()).x(), 3.0f, 1e-5f);
  EXPECT_NEAR(light.radiance(Vec3::UnitZ()).x(), 0.0f, 1e-5f);
  map->rotation_rad = 0.5f * kPi;  // Content that was ahead is now to the right.
  light = EnvironmentLight({}, map);
  EXPECT_NEAR(light.radiance(Vec3::UnitX()).x(), 2.0f, 1e-5f);
}

TEST(EnvironmentLight, samples_a_sun_of_one_texel_without_noise) {
  auto map = map_of(64, 32, 0.01f);
  for (int i = 0; i < 3; ++i) map->pixels.at(20, 8)[i] = 1e6f;
  const EnvironmentLight light({}, map);
  for (int i = 0; i < 256; ++i) {
    LightSample aim;
    ASSERT_TRUE(light.sample(Vec3::Zero(), SampleSequence(3, 0, 0, i, 256).pair(0), &aim));
    // Light over pdf equals the light of the whole sphere in every direction, except for the variation of the sine
    // within a texel.
    EXPECT_NEAR(aim.radiance_over_pdf.x() / light.estimate(Vec3::Zero()), 1.0f, 0.15f);
  }
}

TEST(EnvironmentLight, is_off_if_it_is_black) {
  EXPECT_FALSE(EnvironmentLight({}, nullptr).shines());
  EXPECT_FALSE(EnvironmentLight({}, map_of(4, 2, 0.0f)).shines());
  EXPECT_EQ(EnvironmentLight({}, map_of(4, 2, 0.0f)).pdf(Vec3::Zero(), Vec3::UnitY()), 0.0f);
}

TEST(EnvironmentLight, is_finite_at_the_poles) {
  const EnvironmentLight light({}, noisy_map(16, 8));
  for (const Vec3& direction : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(1e-20f, 1, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1)}) {
    EXPECT_TRUE(std::isfinite(light.pdf(Vec3::Zero(), direction)));
    EXPECT_TRUE(is_finite(light.radiance(direction)));
  }
}

}  // namespace
}  // namespace cyclorama::render
