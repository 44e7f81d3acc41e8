// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/lamp.h"

#include <gtest/gtest.h>

#include "tests/data_sets/simple_scenes.h"
#include "tests/support/light_checks.h"
#include "tests/support/statistics.h"

namespace cyclorama::render {
namespace {

Lamp lamp_of(const scene::Light& light) { return make_lamp(light, Eigen::Vector3d::Zero()); }

scene::Light sphere(const Eigen::Vector3d& at, double radius, float candela = 1.0f) {
  scene::Light light = point_light(at, candela);
  light.radius_m = radius;
  light.visible = true;
  return light;
}

double irradiance(const Lamp& lamp, const Vec3& p, const Vec3& n) {
  return sampled_irradiance(
      [&](float, const Vec2& u, LightSample* aim) {
        *aim = sample_lamp(lamp, p, u);
        return true;
      },
      n);
}

TEST(Lamp, a_sphere_above_the_horizon_gives_the_light_of_a_point) {
  for (const double radius : {0.0, 1e-20, 1e-7, 1e-4, 0.01, 0.5, 0.99}) {
    const double expected = 7.0 * 2.0 / std::pow(5.0, 1.5);
    EXPECT_NEAR(irradiance(lamp_of(sphere({1, 2, 0}, radius, 7.0f)), Vec3::Zero(), Vec3::UnitY()), expected,
                1e-3 * expected)
        << radius;
  }
}

TEST(Lamp, samples_follow_the_pdf) {
  for (const scene::Light& light : {sphere({1, 2, 0.5}, 0.5), sphere({0, 0, 2}, 1.9), sphere({0.1, 0.2, 0}, 3.0)}) {
    const Lamp lamp = lamp_of(light);
    const float cos_rim = std::sqrt(std::max(0.0f, 1.0f - std::pow(lamp.radius / lamp.position.norm(), 2.0f)));
    const bool inside = lamp.position.norm() < lamp.radius;
    const auto sample = [&](const Vec2& u, float) -> std::optional<Vec3> {
      return sample_lamp(lamp, Vec3::Zero(), u).direction;
    };
    const auto pdf = [&](const Vec3& direction) {
      const bool meets = inside || direction.dot(lamp.position.normalized()) >= cos_rim;
      return meets ? lamp_pdf(lamp, Vec3::Zero()) : 0.0f;
    };
    const SamplerCheck check = check_sampler(sample, pdf, 1 << 14, 3, 5);
    EXPECT_GT(check.chi_square.p_value, 0.003) << light.radius_m << " " << check.chi_square.statistic;
    EXPECT_NEAR(check.integral, 1.0, 0.02) << light.radius_m;
  }
}

TEST(Lamp, shadow_rays_end_before_its_surface) {
  const Lamp lamp = lamp_of(sphere({3, 0, 0}, 0.5));
  for (int i = 0; i < 256; ++i) {
    const LightSample aim = sample_lamp(lamp, Vec3::Zero(), SampleSequence(2, 0, 0, i, 256).pair(0));
    const float off = (aim.direction * aim.distance - lamp.position).norm();
    EXPECT_NEAR(off, 0.5f, 2e-3f);
    EXPECT_GE(off, 0.5f - 1e-6f);
    EXPECT_EQ(aim.pdf, lamp_pdf(lamp, Vec3::Zero()));
  }
}

TEST(Lamp, light_comes_from_all_directions_inside_the_sphere) {
  const double radiance = 3.0 / (std::numbers::pi * 4.0);
  EXPECT_NEAR(irradiance(lamp_of(sphere({0, 0.2, 0}, 2.0, 3.0f)), Vec3::Zero(), Vec3::UnitX()),
              std::numbers::pi * radiance, 0.01);
}

TEST(Lamp, a_directional_lamp_gives_its_lux_at_any_angular_size) {
  for (const double tangent : {0.0, 0.00465, 0.2}) {
    scene::Light light;
    light.kind = scene::LightKind::kDirectional;
    light.direction = Eigen::Vector3d(0, -1, 0);
    light.intensity = Eigen::Vector3f::Constant(5.0f);
    light.radius_m = tangent;
    const double mean_cosine = (1.0 + std::cos(std::atan(tangent))) / 2.0;
    EXPECT_NEAR(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), 5.0 * mean_cosine, 5e-3);
  }
}

TEST(Lamp, a_spot_shines_only_inside_its_cone_and_fades_towards_its_edge) {
  scene::Light light = point_light({0, 1, 0}, 1.0f);
  light.kind = scene::LightKind::kSpot;
  light.inner_cone_rad = 0.3;
  light.outer_cone_rad = 0.6;
  const Lamp lamp = lamp_of(light);
  const auto at = [&](double angle) {
    return irradiance(lamp, {static_cast<float>(std::tan(angle)), 0, 0}, Vec3::UnitY()) /
           std::pow(std::cos(angle), 3.0);
  };
  EXPECT_NEAR(at(0.0), 1.0, 1e-4);
  EXPECT_NEAR(at(0.29), 1.0, 1e-4);
  EXPECT_GT(at(0.45), 0.05);
  EXPECT_LT(at(0.45), 0.95);
  EXPECT_EQ(at(0.61), 0.0);
}

TEST(Lamp, light_ends_at_the_range) {
  scene::Light light = point_light({0, 2, 0}, 1.0f);
  light.range_m = 1.9;
  EXPECT_EQ(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), 0.0);
  light.range_m = 2.1;
  EXPECT_GT(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), 0.0);
}

TEST(Lamp, is_finite_for_points_on_its_surface) {
  for (const double radius : {0.0, 1e-30, 1e-3, 0.5}) {
    const Lamp lamp = lamp_of(sphere({0, 0, 0}, radius));
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(static_cast<float>(radius), 0, 0), Vec3(1e-20f, 0, 0)}) {
      const LightSample aim = sample_lamp(lamp, p, {0.5f, 0.5f});
      EXPECT_TRUE(is_finite(aim.radiance_over_pdf) && is_finite(aim.direction)) << radius;
      EXPECT_FALSE(std::isnan(aim.distance) || std::isnan(aim.pdf)) << radius;
    }
  }
}

}  // namespace
}  // namespace cyclorama::render
