// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/flat_light.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/light_checks.h"
#include "tests/support/statistics.h"

namespace cyclorama::render {
namespace {

/// A light as seen from the origin.
struct Case {
  std::string name;
  scene::Light light;
  bool is_small = false;  ///< Too small or thin for integration over the bins of a histogram.
};

scene::Light rectangle(const Eigen::Vector3d& at, const Eigen::Vector3d& direction, double width, double height) {
  scene::Light light;
  light.kind = scene::LightKind::kRectangle;
  light.position = at;
  light.direction = direction.normalized();
  light.across = light.direction.unitOrthogonal();
  light.size_m = {width, height};
  light.visible = true;
  return light;
}

scene::Light disk(const Eigen::Vector3d& at, const Eigen::Vector3d& direction, double radius) {
  scene::Light light = rectangle(at, direction, 0.0, 0.0);
  light.kind = scene::LightKind::kDisk;
  light.radius_m = radius;
  return light;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"rectangle above", rectangle({0, 2, 0}, {0, -1, 0}, 1.5, 1.5)},
      {"rectangle aside", rectangle({3, 1, -2}, {-1, -0.3, 0.5}, 2.0, 0.5)},
      {"long rectangle", rectangle({0, 1, 0}, {0, -1, 0}, 20.0, 0.02)},
      {"near rectangle", rectangle({0.3, 0.01, 0.2}, {0, -1, 0}, 2.0, 2.0)},
      {"huge rectangle", rectangle({300, 0.5, -100}, {0, -1, 0}, 1e4, 2e3)},
      {"grazing rectangle", rectangle({0, 0.05, 3}, {0, -1, 0}, 2.0, 2.0), true},
      {"beside its plane", rectangle({1.0001, 0.0, 0.001}, {-1e-3, -1, 0}, 2.0, 2.0)},
      {"far rectangle", rectangle({0, 50, 3}, {0.2, -1, 0}, 1.0, 2.0), true},
      {"tiny rectangle", rectangle({0, 1, 0}, {0, -1, 0.1}, 1e-5, 1e-5), true},
      {"disk above", disk({0, 2, 0}, {0, -1, 0}, 1.0)},
      {"disk aside", disk({2, 1, -1}, {-1, -0.2, 0.4}, 1.0)},
      {"near disk", disk({0.2, 0.02, 0}, {0, -1, 0}, 1.0)},
      {"huge disk", disk({100, 0.5, 0}, {0, -1, 0}, 1e4)},
      {"far disk", disk({0, 30, 3}, {0.2, -1, 0}, 1.0), true},
      {"tiny disk", disk({0, 1, 0}, {0, -1, 0.1}, 1e-5), true},
  };
  return all;
}

FlatLight flat(const scene::Light& light) { return make_flat_light(light, Eigen::Vector3d::Zero()); }

/// Finds the point where a ray from `p` hits the light; returns false if it misses.
bool meets(const FlatLight& light, const Vec3& p, const Vec3& direction, double* ret_distance) {
  const Eigen::Vector3d n = light.normal.cast<double>();
  const Eigen::Vector3d d = direction.cast<double>();
  const double cosine = -n.dot(d);
  if (!(cosine > 0.0)) return false;
  const Eigen::Vector3d offset = light.centre.cast<double>() - p.cast<double>();
  *ret_distance = -offset.dot(n) / cosine;
  const Eigen::Vector3d at = d * *ret_distance - offset;
  const double x = at.dot(light.across.cast<double>()) / static_cast<double>(light.half.x());
  const double y = at.dot(light.up.cast<double>()) / static_cast<double>(light.half.y());
  return *ret_distance > 0.0 && (light.is_disk ? x * x + y * y <= 1.0 : std::abs(x) <= 1.0 && std::abs(y) <= 1.0);
}

TEST(FlatLight, samples_follow_the_pdf) {
  const double level = sidak(0.01, static_cast<int>(cases().size()));
  for (const Case& at : cases()) {
    if (at.is_small) continue;
    const FlatLight light = flat(at.light);
    const auto sample = [&](const Vec2& u, float) -> std::optional<Vec3> {
      LightSample aim;
      if (!sample_flat(light, Vec3::Zero(), u, &aim)) return std::nullopt;
      return aim.direction;
    };
    const auto pdf = [&](const Vec3& direction) {
      double distance = 0.0;
      if (!meets(light, Vec3::Zero(), direction, &distance)) return 0.0f;
      return flat_pdf(light, Vec3::Zero(), direction, static_cast<float>(distance));
    };
    const SamplerCheck check = check_sampler(sample, pdf, 1 << 14, 7, 6);
    EXPECT_GT(check.chi_square.p_value, level) << at.name << " " << check.chi_square.statistic;
    EXPECT_NEAR(check.integral + check.lost, 1.0, 0.03) << at.name;
  }
}

TEST(FlatLight, a_sample_has_the_pdf_of_a_ray_in_its_direction) {
  for (const Case& at : cases()) {
    const FlatLight light = flat(at.light);
    int aims = 0;
    for (int i = 0; i < 64; ++i) {
      LightSample aim;
      if (!sample_flat(light, Vec3::Zero(), SampleSequence(2, 0, 0, i, 64).pair(0), &aim)) continue;
      ++aims;
      const double cosine = -(light.normal.dot(aim.direction));
      const double distance = -light.centre.dot(light.normal) / cosine;
      EXPECT_NEAR(flat_pdf(light, Vec3::Zero(), aim.direction, static_cast<float>(distance)) / aim.pdf, 1.0f, 0.01f)
          << at.name;
      EXPECT_LT(aim.distance, distance) << at.name;
      EXPECT_NEAR(aim.radiance_over_pdf.x() * aim.pdf, 1.0f, 1e-4f) << at.name;
    }
    EXPECT_GT(aims, 32) << at.name;
  }
}

TEST(FlatLight, a_rectangle_follows_lamberts_formula) {
  for (const Case& at : cases()) {
    if (at.light.kind != scene::LightKind::kRectangle) continue;
    const FlatLight light = flat(at.light);
    std::vector<Eigen::Vector3d> corners;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      corners.push_back(light.centre.cast<double>() +
                        x * static_cast<double>(light.half.x()) * light.across.cast<double>() +
                        y * static_cast<double>(light.half.y()) * light.up.cast<double>());
    }
    Vec3 n = Vec3::UnitY();
    if (at.name == "grazing rectangle") n = Vec3::UnitZ();
    if (at.name == "beside its plane") n = Vec3::UnitX();
    const double expected = polygon_irradiance(corners, n.cast<double>());
    const auto sample = [&](float, const Vec2& u, LightSample* aim) {
      return sample_flat(light, Vec3::Zero(), u, aim);
    };
    EXPECT_NEAR(sampled_irradiance(sample, n) / expected, 1.0, at.name == "beside its plane" ? 0.02 : 0.005) << at.name;
  }
}

TEST(FlatLight, a_disk_overhead_gives_pi_times_the_squared_sine_of_its_half_angle) {
  for (const double radius : {1e-4, 0.1, 0.5, 1.0, 30.0}) {
    const FlatLight light = flat(disk({0, 1.2, 0}, {0, -1, 0}, radius));
    const auto sample = [&](float, const Vec2& u, LightSample* aim) {
      return sample_flat(light, Vec3::Zero(), u, aim);
    };
    const double expected = std::numbers::pi * radius * radius / (radius * radius + 1.44);
    EXPECT_NEAR(sampled_irradiance(sample, Vec3::UnitY()) / expected, 1.0, 0.01) << radius;
  }
}

TEST(FlatLight, shines_on_one_side_and_is_finite_on_itself) {
  LightSample aim;
  for (const scene::Light& light : {rectangle({0, 0, 0}, {0, -1, 0}, 1, 1), disk({0, 0, 0}, {0, -1, 0}, 1)}) {
    const FlatLight made = flat(light);
    for (const float height : {0.0f, 1e-30f, 1.0f, 1e20f}) {
      EXPECT_FALSE(sample_flat(made, {0.1f, height, 0.1f}, {0.5f, 0.5f}, &aim)) << height;
      EXPECT_EQ(flat_pdf(made, {0.1f, height, 0.1f}, -Vec3::UnitY(), height), 0.0f);
    }
    for (const float depth : {-1e-30f, -1e-10f, -1e10f, -1e18f}) {
      for (const Vec2& u : {Vec2(0.0f, 0.0f), Vec2(0.5f, 0.5f), Vec2(0.99999994f, 0.99999994f)}) {
        if (!sample_flat(made, {0.4f, depth, 0.4f}, u, &aim)) continue;
        EXPECT_TRUE(is_finite(aim.direction) && is_finite(aim.radiance_over_pdf)) << depth;
        EXPECT_FALSE(std::isnan(aim.pdf) || std::isnan(aim.distance)) << depth;
      }
    }
  }
}

TEST(FlatLight, is_off_without_an_area_or_with_invalid_numbers) {
  EXPECT_FALSE(is_lit(flat(rectangle({0, 0, 0}, {0, -1, 0}, 0, 1))));
  EXPECT_FALSE(is_lit(flat(rectangle({0, 0, 0}, {0, -1, 0}, 1e-30, 1e-30))));
  EXPECT_FALSE(is_lit(flat(disk({0, 0, 0}, {0, -1, 0}, 0))));
  EXPECT_FALSE(is_lit(flat(disk({std::nan(""), 0, 0}, {0, -1, 0}, 1))));
  scene::Light dark = disk({0, 0, 0}, {0, -1, 0}, 1);
  dark.intensity.setConstant(-1.0f);
  EXPECT_FALSE(is_lit(flat(dark)));
}

TEST(FlatLight, samples_of_an_invisible_light_have_no_pdf) {
  scene::Light light = rectangle({0, 2, 0}, {0, -1, 0}, 1, 1);
  light.visible = false;
  LightSample aim;
  ASSERT_TRUE(sample_flat(flat(light), Vec3::Zero(), {0.3f, 0.3f}, &aim));
  EXPECT_EQ(aim.pdf, 0.0f);
  EXPECT_GT(aim.radiance_over_pdf.x(), 0.0f);
}

}  // namespace
}  // namespace cyclorama::render
