// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/bsdf.h"

#include <gtest/gtest.h>

#include "renderfarm/render/requirements.h"
#include "tests/unit/renderfarm/render/bsdf_cases.h"

namespace cyclorama::render {
namespace {

TEST(Scattering, a_matte_surface_is_exactly_lambert_at_every_level) {
  const Bsdf bsdf = make_matte({0.2f, 0.4f, 0.6f});
  for (const SurfaceLevel level : {SurfaceLevel::kMatte, SurfaceLevel::kGlossy, SurfaceLevel::kLayered}) {
    with_scattering({"", level, bsdf}, Vec3::UnitZ(), direction(0.3, 0.0), [&](const auto& scattering) {
      EXPECT_TRUE(scattering.evaluate(direction(0.5, 1.0)).isApprox(bsdf.base_colour * std::cos(0.5f) / kPi, 1e-5f));
      EXPECT_TRUE(scattering.evaluate(-Vec3::UnitZ()).isZero(0.0f));
      EXPECT_TRUE(scattering.albedo().isApprox(bsdf.base_colour, 1e-6f));
      const ScatterSample sample = scattering.sample({0.3f, 0.9f}, 0.5f);
      EXPECT_GT(sample.wi.z(), 0.0f);
      EXPECT_FALSE(sample.through);
      EXPECT_TRUE(sample.weight.isApprox(bsdf.base_colour, 1e-5f));
    });
  }
}

TEST(Scattering, a_level_agrees_with_the_one_below_it) {
  const scene::Material material = [] {
    scene::Material plastic = white_material(0.4f);
    plastic.base_colour << 0.7f, 0.3f, 0.2f, 1.0f;
    return plastic;
  }();
  const Bsdf bsdf = make_bsdf(material, SurfaceTexels{}, false, SurfaceLevel::kLayered);
  const Vec3 wo = direction(0.8, 0.1);
  const Scattering<SurfaceLevel::kGlossy> glossy(bsdf, Vec3::UnitZ(), wo);
  const Scattering<SurfaceLevel::kLayered> layered(bsdf, Vec3::UnitZ(), wo);
  for (const double polar : {0.0, 0.5, 0.8, 1.5}) {
    const Vec3 wi = direction(polar, 3.0);
    EXPECT_TRUE(glossy.evaluate(wi).isApprox(layered.evaluate(wi), 1e-5f));
    EXPECT_NEAR(glossy.pdf(wi), layered.pdf(wi), 1e-4f * glossy.pdf(wi));
  }
}

TEST(Scattering, a_polished_metal_is_a_mirror) {
  const Bsdf bsdf = make_glossy({0.9f, 0.6f, 0.3f}, 1.0f, 0.0f);
  const Vec3 wo = direction(0.7, 0.2);
  const Scattering<SurfaceLevel::kGlossy> scattering(bsdf, Vec3::UnitZ(), wo);
  const Vec3 mirrored(-wo.x(), -wo.y(), wo.z());
  EXPECT_TRUE(scattering.evaluate(mirrored).isZero(1e-6f));
  const ScatterSample sample = scattering.sample({0.1f, 0.2f}, 0.5f);
  EXPECT_EQ(sample.pdf, 0.0f);
  EXPECT_TRUE(sample.wi.isApprox(mirrored, 1e-6f));
  EXPECT_NEAR(sample.weight.x(), 0.9f, 1e-2f);
}

TEST(Scattering, glass_of_index_1_is_invisible) {
  for (const float roughness : {0.0f, 0.5f, 1.0f}) {
    for (const bool inside : {false, true}) {
      const Bsdf bsdf = make_bsdf(glass_material(roughness, 1.0f, false), {}, inside, SurfaceLevel::kLayered);
      for (const double polar : {0.0, 1.0, 1.55}) {
        const Vec3 wo = direction(polar, 0.4);
        const Scattering<SurfaceLevel::kLayered> scattering(bsdf, Vec3::UnitZ(), wo);
        for (const float choice : {0.0f, 0.5f, 0.999f}) {
          const ScatterSample sample = scattering.sample({0.3f, 0.6f}, choice);
          EXPECT_TRUE(sample.through);
          EXPECT_TRUE(sample.wi.isApprox(-wo, 1e-6f));
          EXPECT_TRUE(sample.weight.isApprox(Vec3(Vec3::Ones()), 1e-6f));
        }
      }
    }
  }
}

TEST(Scattering, clear_glass_refracts_by_snells_law) {
  const Bsdf bsdf = make_bsdf(glass_material(0.0f, 1.5f, false), {}, false, SurfaceLevel::kLayered);
  const Vec3 wo = direction(0.9, 0.0);
  const Scattering<SurfaceLevel::kLayered> scattering(bsdf, Vec3::UnitZ(), wo);
  const ScatterSample sample = scattering.sample({0.5f, 0.5f}, 0.99f);
  ASSERT_TRUE(sample.through);
  EXPECT_NEAR(sample.wi.x(), -std::sin(0.9f) / 1.5f, 1e-6f);
  EXPECT_NEAR(sample.weight.x(), 1.0f, 1e-5f);
  // Also traces the reverse path from inside.
  const Bsdf back = make_bsdf(glass_material(0.0f, 1.5f, false), {}, true, SurfaceLevel::kLayered);
  const Scattering<SurfaceLevel::kLayered> leaving(back, -Vec3::UnitZ(), sample.wi);
  EXPECT_TRUE(leaving.sample({0.5f, 0.5f}, 0.99f).wi.isApprox(wo, 1e-5f));
}

TEST(Scattering, beyond_the_critical_angle_all_light_is_reflected) {
  const Bsdf bsdf = make_bsdf(glass_material(0.0f, 1.5f, false), {}, true, SurfaceLevel::kLayered);
  const Scattering<SurfaceLevel::kLayered> scattering(bsdf, Vec3::UnitZ(), direction(0.8, 0.0));
  for (const float choice : {0.0f, 0.5f, 0.999f}) {
    const ScatterSample sample = scattering.sample({0.5f, 0.5f}, choice);
    EXPECT_FALSE(sample.through);
    EXPECT_NEAR(sample.weight.x(), 1.0f, 1e-5f);
  }
}

TEST(Scattering, a_clear_sheet_does_not_refract_light) {
  const Bsdf bsdf = make_bsdf(glass_material(0.0f, 1.5f, true), {}, true, SurfaceLevel::kLayered);
  const Vec3 wo = direction(1.0, 0.3);
  const ScatterSample sample = Scattering<SurfaceLevel::kLayered>(bsdf, Vec3::UnitZ(), wo).sample({0.5f, 0.5f}, 0.99f);
  EXPECT_TRUE(sample.through);
  EXPECT_TRUE(sample.wi.isApprox(-wo, 1e-6f));
}

TEST(Scattering, without_specular_a_dielectric_is_matte) {
  scene::Material material = white_material(0.2f);
  material.specular = 0.0f;
  const Bsdf bsdf = make_bsdf(material, {}, false, SurfaceLevel::kGlossy);
  const Scattering<SurfaceLevel::kGlossy> scattering(bsdf, Vec3::UnitZ(), direction(0.5, 0.0));
  EXPECT_NEAR(scattering.evaluate(direction(0.5, 3.14)).x(), std::cos(0.5f) / kPi, 1e-4f);
}

TEST(Absorption, has_the_attenuation_colour_at_its_distance) {
  scene::Material material = glass_material(0.0f, 1.5f, false);
  EXPECT_TRUE(absorption_of(material).isZero(0.0f));
  material.attenuation_colour << 0.5f, 1.0f, 0.0f;
  material.attenuation_distance = 0.25f;
  const Vec3 absorption = absorption_of(material);
  EXPECT_NEAR(std::exp(-0.25f * absorption.x()), 0.5f, 1e-6f);
  EXPECT_EQ(absorption.y(), 0.0f);
  EXPECT_EQ(std::exp(-absorption.z()), 0.0f);
  for (const float distance : {0.0f, -1.0f, std::numeric_limits<float>::infinity(), NAN}) {
    material.attenuation_distance = distance;
    EXPECT_TRUE(absorption_of(material).isZero(0.0f));
  }
  material.attenuation_distance = std::numeric_limits<float>::denorm_min();
  EXPECT_TRUE(is_finite(absorption_of(material)));
  material.thickness = 0.0f;
  EXPECT_TRUE(absorption_of(material).isZero(0.0f));
}

TEST(SurfaceLevel, is_the_lowest_that_can_show_a_material) {
  scene::Material material = white_material(1.0f);
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kMatte);
  material.ior = 1.8f;
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kGlossy);
  material.specular = 0.0f;
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kMatte);
  material = white_material(0.5f);
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kGlossy);
  material.transmission = 0.5f;
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kLayered);
  material.metallic = 1.0f;  // A metal transmits nothing.
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kGlossy);
  material.clearcoat = 0.1f;
  EXPECT_EQ(surface_level_of(material, {}), SurfaceLevel::kLayered);
}

void expect_numbers(const BsdfCase& at, const Vec3& wo) {
  with_scattering(at, Vec3::UnitZ(), wo, [&](const auto& scattering) {
    EXPECT_TRUE(is_finite(scattering.albedo())) << at.name;
    for (const Vec3& wi : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-wo), wo, Vec3(0, 0, -1), Vec3(-wo.x(), -wo.y(), wo.z()),
                           Vec3(0.99999994f, 0, 1e-6f), Vec3(0.99999994f, 0, -1e-6f)}) {
      EXPECT_TRUE(is_finite(scattering.evaluate(wi))) << at.name;
      EXPECT_GE(scattering.evaluate(wi).minCoeff(), 0.0f) << at.name;
      EXPECT_TRUE(std::isfinite(scattering.pdf(wi)) && scattering.pdf(wi) >= 0.0f) << at.name;
    }
    for (const Vec2& u : {Vec2(0, 0), Vec2(0.99999994f, 0.99999994f), Vec2(0.5f, 0.0f), Vec2(0.0f, 0.99999994f)}) {
      for (const float choice : {0.0f, 0.25f, 0.5f, 0.75f, 0.99999994f}) {
        const ScatterSample sample = scattering.sample(u, choice);
        EXPECT_TRUE(is_finite(sample.weight) && std::isfinite(sample.pdf)) << at.name;
        EXPECT_GE(sample.weight.minCoeff(), 0.0f) << at.name;
        EXPECT_NEAR(sample.wi.norm(), 1.0f, 1e-3f) << at.name;
      }
    }
  });
}

TEST(Scattering, is_finite_for_extreme_parameters) {
  std::vector<BsdfCase> cases = white_cases();
  for (const float roughness : {0.0f, 1e-6f, 0.0316f, 0.032f, 1.0f, -1.0f, 5.0f, NAN}) {
    for (const float ior : {1.0f, 1.0005f, 1.002f, 1e3f, scene::kMaxIor}) {
      for (const float base : {0.0f, 1.0f}) {
        scene::Material material = glass_material(roughness, ior, false);
        material.base_colour.head<3>().setConstant(base);
        material.clearcoat = 1.0f;
        material.clearcoat_roughness = roughness;
        for (const float transmission : {0.0f, 1.0f}) {
          material.transmission = transmission;
          cases.push_back(bsdf_case("body", material, SurfaceLevel::kLayered));
          cases.push_back(bsdf_case("body from inside", material, SurfaceLevel::kLayered, true));
        }
        material.thickness = 0.0f;
        cases.push_back(bsdf_case("sheet", material, SurfaceLevel::kLayered));
        material.specular = 0.0f;
        cases.push_back(bsdf_case("dull", material, SurfaceLevel::kGlossy));
      }
    }
  }
  for (const BsdfCase& at : cases) {
    for (const Vec3& wo : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0.9999f, 0, 0.0141f)}) {
      expect_numbers(at, wo);
    }
  }
}

}  // namespace
}  // namespace cyclorama::render
