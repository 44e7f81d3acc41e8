// SPDX-License-Identifier: Apache-2.0
// Energy of the BSDFs: the white furnace, albedo() and reciprocity.
#include <gtest/gtest.h>

#include <random>

#include "renderfarm/render/sampler.h"
#include "tests/unit/renderfarm/render/bsdf_cases.h"

namespace cyclorama::render {
namespace {

/// Returns the reflected and transmitted light under uniform illumination of radiance 1. Sampling is verified
/// elsewhere; its mean weight includes mirrors.
template <typename Scatter>
Vec3 returned(const Scatter& scattering, int samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < samples; ++i) {
    const SampleSequence sequence(5, 0, 0, i, samples);
    sum += scattering.sample(sequence.pair(0), sequence.pair(1).x()).weight.template cast<double>();
  }
  return (sum / samples).cast<float>();
}

TEST(BsdfEnergy, a_white_surface_in_a_white_furnace_is_white) {
  for (const BsdfCase& at : white_cases()) {
    for (const double polar : {0.0, 0.7, 1.2, 1.45}) {
      with_scattering(at, Vec3::UnitZ(), direction(polar, 0.7), [&](const auto& scattering) {
        EXPECT_NEAR(returned(scattering, 1 << 12).x(), 1.0f, 0.025f) << at.name << " seen at " << polar;
      });
    }
  }
}

TEST(BsdfEnergy, no_surface_gains_energy) {
  for (const BsdfCase& at : tinted_cases()) {
    for (const double polar : {0.0, 0.8, 1.3, 1.55}) {
      with_scattering(at, Vec3::UnitZ(), direction(polar, 0.7), [&](const auto& scattering) {
        EXPECT_LE(returned(scattering, 1 << 12).maxCoeff(), 1.025f) << at.name << " seen at " << polar;
      });
    }
  }
}

TEST(BsdfEnergy, albedo_is_the_reflected_light) {
  for (const BsdfCase& at : tinted_cases()) {
    for (const double polar : {0.0, 0.8, 1.3}) {
      with_scattering(at, Vec3::UnitZ(), direction(polar, 0.7), [&](const auto& scattering) {
        const Vec3 found = returned(scattering, 1 << 12);
        const Vec3 said = scattering.albedo();
        // Albedos of coats with their own normal, and of bodies seen from inside, are approximate.
        const float slack = at.bsdf.inside || !at.bsdf.coat_normal.isZero() ? 0.15f : 0.04f;
        EXPECT_LE((found - said).cwiseAbs().maxCoeff(), slack)
            << at.name << " seen at " << polar << ": " << found.transpose() << " for " << said.transpose();
      });
    }
  }
}

float evaluated(const BsdfCase& at, const Vec3& wo, const Vec3& wi) {
  float value = 0.0f;
  with_scattering(at, Vec3::UnitZ(), wo, [&](const auto& scattering) { value = scattering.evaluate(wi).y(); });
  return value / std::abs(wi.z());
}

TEST(BsdfEnergy, is_reciprocal_above_the_surface) {
  std::vector<BsdfCase> cases = white_cases();
  const std::vector<BsdfCase> tinted = tinted_cases();
  cases.insert(cases.end(), tinted.begin(), tinted.end());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> polar(0.05, 1.5);
  for (const BsdfCase& at : cases) {
    if (!at.bsdf.coat_normal.isZero()) continue;  // Two normals give two cosines: no normal map is reciprocal.
    for (int i = 0; i < 20; ++i) {
      const Vec3 a = direction(polar(random), 4.0 * polar(random));
      const Vec3 b = direction(polar(random), -3.0 * polar(random));
      const float there = evaluated(at, a, b);
      EXPECT_NEAR(there, evaluated(at, b, a), 2e-3f * std::max(1.0f, there)) << at.name;
    }
  }
}

/// Seen through the surface, the other side of a body is a surface of the inverse index with a reversed normal.
TEST(BsdfEnergy, is_reciprocal_through_the_surface) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> polar(0.05, 1.5);
  for (const float coat : {0.0f, 1.0f}) {
    for (const bool thin : {false, true}) {
      for (const float roughness : {0.2f, 0.5f, 1.0f}) {
        scene::Material material = glass_material(roughness, 1.5f, thin);
        material.clearcoat = coat;
        const float ior2 = thin ? 1.0f : material.ior * material.ior;
        const BsdfCase outside = bsdf_case("outside", material, SurfaceLevel::kLayered);
        const BsdfCase inside = bsdf_case("inside", material, SurfaceLevel::kLayered, true);
        for (int i = 0; i < 50; ++i) {
          const Vec3 a = direction(polar(random), 4.0 * polar(random));
          const Vec3 b = -direction(polar(random), -3.0 * polar(random));
          float back = 0.0f;
          with_scattering(inside, -Vec3::UnitZ(), b, [&](const auto& s) { back = s.evaluate(a).y() / a.z(); });
          const float there = evaluated(outside, a, b);
          EXPECT_NEAR(there / ior2, back, 2e-3f * std::max(1.0f, back)) << roughness << (thin ? " thin" : " body");
        }
      }
    }
  }
}

}  // namespace
}  // namespace cyclorama::render
