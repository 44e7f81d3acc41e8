// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lamps.h"

#include <gtest/gtest.h>

#include <numbers>

#include "renderfarm/render/sampler.h"
#include "tests/doubles/simple_scenes.h"

namespace cyclorama {
namespace {

constexpr int kSamples = 1 << 14;

Lamp lamp_of(const Light& light) { return make_lamps({light}, Eigen::Vector3d::Zero()).at(0); }

/// Mean of light times cosine over many aims: irradiance.
double irradiance(const Lamp& lamp, const Vec3& p, const Vec3& n) {
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const LampAim at = aim(lamp, p, SampleSequence(1, 0, 0, i, kSamples).pair(0));
    EXPECT_NEAR(at.direction.norm(), 1.0f, 1e-4f);
    sum += static_cast<double>(at.light.x() * std::max(0.0f, n.dot(at.direction)));
  }
  return sum / kSamples;
}

TEST(Lamps, a_sphere_gives_what_a_point_gives_while_all_of_it_is_above_the_horizon) {
  for (const double radius : {0.0, 1e-4, 0.01, 0.5, 0.99}) {
    Light light = point_light({1, 2, 0}, 7.0f);
    light.radius_m = radius;
    const double expected = 7.0 * 2.0 / std::pow(5.0, 1.5);
    EXPECT_NEAR(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), expected, 1e-3 * expected) << radius;
  }
}

TEST(Lamps, aims_end_on_the_lamps_surface) {
  Light light = point_light({3, 0, 0}, 1.0f);
  light.radius_m = 0.5;
  const Lamp lamp = lamp_of(light);
  for (int i = 0; i < 256; ++i) {
    const LampAim at = aim(lamp, Vec3::Zero(), SampleSequence(2, 0, 0, i, 256).pair(0));
    EXPECT_NEAR((at.direction * at.distance - lamp.position).norm(), 0.5f, 2e-3f);
    EXPECT_LE(at.distance, 3.0f);
  }
}

TEST(Lamps, inside_the_sphere_light_comes_from_everywhere) {
  Light light = point_light({0, 0.2, 0}, 3.0f);
  light.radius_m = 2.0;
  const double radiance = 3.0 / (std::numbers::pi * 4.0);
  EXPECT_NEAR(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitX()), std::numbers::pi * radiance, 0.01);
}

TEST(Lamps, a_directional_lamp_gives_its_lux_whatever_its_size) {
  for (const double tangent : {0.0, 0.00465, 0.2}) {
    Light light;
    light.kind = LightKind::kDirectional;
    light.direction = Eigen::Vector3d(0, -1, 0);
    light.intensity = Eigen::Vector3f::Constant(5.0f);
    light.radius_m = tangent;
    const double mean_cosine = (1.0 + std::cos(std::atan(tangent))) / 2.0;
    EXPECT_NEAR(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), 5.0 * mean_cosine, 5e-3);
  }
}

TEST(Lamps, a_spot_shines_inside_its_cone_only_and_fades_between) {
  Light light = point_light({0, 1, 0}, 1.0f);
  light.kind = LightKind::kSpot;
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
  EXPECT_EQ(estimate(lamp, {std::tan(0.61f), 0, 0}, Vec3::UnitY()), 0.0f);
}

TEST(Lamps, light_ends_at_the_range) {
  Light light = point_light({0, 2, 0}, 1.0f);
  light.range_m = 1.9;
  EXPECT_EQ(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), 0.0);
  light.range_m = 2.1;
  EXPECT_GT(irradiance(lamp_of(light), Vec3::Zero(), Vec3::UnitY()), 0.0);
}

TEST(Lamps, dark_lamps_are_left_out) {
  EXPECT_TRUE(
      make_lamps({point_light({0, 0, 0}, 0.0f), point_light({0, 0, 0}, -1.0f)}, Eigen::Vector3d::Zero()).empty());
}

/// The estimator over many choices is the sum over all lamps: nothing is lost or doubled.
TEST(Lamps, choosing_one_of_many_is_unbiased) {
  for (const int count : {1, 3, 60, 500}) {
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
      lights.push_back(point_light({std::sin(i) * 5.0, 1.0 + std::cos(3.0 * i) * 2.0, std::cos(i) * 5.0}, 1.0f));
      lights.back().radius_m = 0.3;
    }
    const std::vector<Lamp> lamps = make_lamps(lights, Eigen::Vector3d::Zero());
    double all = 0.0;
    for (const Lamp& lamp : lamps) {
      if (estimate(lamp, Vec3::Zero(), Vec3::UnitY()) > 0.0f) all += irradiance(lamp, Vec3::Zero(), Vec3::UnitY());
    }
    double sum = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      const SampleSequence sequence(3, 0, 0, i, kSamples);
      float probability = 0.0f;
      const int chosen = choose_lamp(lamps, Vec3::Zero(), Vec3::UnitY(), sequence.pair(1).x(), &probability);
      ASSERT_GE(chosen, 0);
      const LampAim at = aim(lamps[static_cast<std::size_t>(chosen)], Vec3::Zero(), sequence.pair(0));
      sum += static_cast<double>(at.light.x() * std::max(0.0f, at.direction.y()) / probability);
    }
    EXPECT_NEAR(sum / kSamples, all, 0.02 * all) << count;
  }
}

TEST(Lamps, none_is_chosen_where_none_can_shine) {
  const std::vector<Lamp> lamps = make_lamps({point_light({0, -1, 0}, 1.0f)}, Eigen::Vector3d::Zero());
  float probability = 0.0f;
  EXPECT_EQ(choose_lamp(lamps, Vec3::Zero(), Vec3::UnitY(), 0.5f, &probability), -1);
  EXPECT_EQ(choose_lamp({}, Vec3::Zero(), Vec3::UnitY(), 0.5f, &probability), -1);
}

TEST(Lamps, a_point_on_a_lamp_gives_numbers) {
  for (const double radius : {0.0, 0.5}) {
    Light light = point_light({0, 0, 0}, 1.0f);
    light.radius_m = radius;
    const Lamp lamp = lamp_of(light);
    const LampAim at = aim(lamp, Vec3::Zero(), {0.5f, 0.5f});
    EXPECT_TRUE(is_finite(at.light));
    EXPECT_TRUE(is_finite(at.direction));
    float probability = 0.0f;
    const int chosen = choose_lamp({lamp}, Vec3::Zero(), Vec3::UnitY(), 0.5f, &probability);
    EXPECT_TRUE(chosen == -1 || probability > 0.0f);
  }
}

}  // namespace
}  // namespace cyclorama
