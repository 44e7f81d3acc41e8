// SPDX-License-Identifier: Apache-2.0
/// Materials with which every Scattering is tested.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "renderfarm/render/bsdf.h"

namespace cyclorama::render {

struct BsdfCase {
  std::string name;
  SurfaceLevel level = SurfaceLevel::kMatte;
  Bsdf bsdf;
};

/// Returns a white, rough dielectric.
inline scene::Material white_material(float roughness) {
  scene::Material material;
  material.metallic = 0.0f;
  material.roughness = roughness;
  return material;
}

inline scene::Material glass_material(float roughness, float ior, bool thin) {
  scene::Material material = white_material(roughness);
  material.transmission = 1.0f;
  material.ior = ior;
  material.thickness = thin ? 0.0f : 1.0f;
  return material;
}

inline BsdfCase bsdf_case(const std::string& name, const scene::Material& material, SurfaceLevel level,
                          bool inside = false) {
  return {name, level, make_bsdf(material, SurfaceTexels{}, inside, level)};
}

/// White materials: they absorb nothing, so all light that arrives leaves again.
inline std::vector<BsdfCase> white_cases() {
  std::vector<BsdfCase> cases = {bsdf_case("matte", white_material(1.0f), SurfaceLevel::kMatte)};
  for (const float roughness : {0.0f, 0.02f, 0.05f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    const std::string rough = " of roughness " + std::to_string(roughness).substr(0, 4);
    scene::Material material = white_material(roughness);
    cases.push_back(bsdf_case("plastic" + rough, material, SurfaceLevel::kGlossy));
    material.metallic = 1.0f;
    cases.push_back(bsdf_case("metal" + rough, material, SurfaceLevel::kGlossy));
    material.metallic = 0.5f;
    cases.push_back(bsdf_case("half metal" + rough, material, SurfaceLevel::kGlossy));
    material.clearcoat = 0.5f;
    cases.push_back(bsdf_case("half-coated half metal" + rough, material, SurfaceLevel::kLayered));
    material.clearcoat = 1.0f;
    material.metallic = 1.0f;
    cases.push_back(bsdf_case("coated metal" + rough, material, SurfaceLevel::kLayered));
    material.clearcoat_roughness = 0.4f;
    cases.push_back(bsdf_case("roughly coated metal" + rough, material, SurfaceLevel::kLayered));
    material.metallic = 0.0f;
    cases.push_back(bsdf_case("roughly coated plastic" + rough, material, SurfaceLevel::kLayered));
    material = glass_material(roughness, 1.5f, true);
    cases.push_back(bsdf_case("thin glass" + rough, material, SurfaceLevel::kLayered));
    material.transmission = 0.5f;
    material.thickness = 1.0f;
    cases.push_back(bsdf_case("milk glass" + rough, material, SurfaceLevel::kLayered));
    for (const float ior : {1.0f, 1.1f, 1.5f, 2.4f}) {
      const std::string name = "glass of ior " + std::to_string(ior).substr(0, 3) + rough;
      material = glass_material(roughness, ior, false);
      cases.push_back(bsdf_case(name, material, SurfaceLevel::kLayered));
      cases.push_back(bsdf_case(name + " from inside", material, SurfaceLevel::kLayered, true));
    }
  }
  return cases;
}

/// Coloured materials, which absorb some light.
inline std::vector<BsdfCase> tinted_cases() {
  std::vector<BsdfCase> cases;
  for (const float roughness : {0.0f, 0.04f, 0.25f, 0.7f, 1.0f}) {
    const std::string rough = " of roughness " + std::to_string(roughness).substr(0, 4);
    scene::Material material = white_material(roughness);
    material.base_colour << 0.9f, 0.5f, 0.1f, 1.0f;
    cases.push_back(bsdf_case("matte ochre", material, SurfaceLevel::kMatte));
    material.specular_colour << 0.2f, 0.6f, 3.0f;
    cases.push_back(bsdf_case("ochre with blue gloss" + rough, material, SurfaceLevel::kGlossy));
    material.metallic = 0.8f;
    cases.push_back(bsdf_case("gold" + rough, material, SurfaceLevel::kGlossy));
    material.clearcoat = 0.7f;
    cases.push_back(bsdf_case("lacquered gold" + rough, material, SurfaceLevel::kLayered));
    material = glass_material(roughness, 1.7f, false);
    material.base_colour << 0.2f, 0.5f, 0.9f, 1.0f;
    material.metallic = 0.2f;
    material.transmission = 0.6f;
    material.specular = 0.5f;
    cases.push_back(bsdf_case("blue milk glass" + rough, material, SurfaceLevel::kLayered));
    material.clearcoat = 1.0f;
    cases.push_back(bsdf_case("coated blue milk glass" + rough, material, SurfaceLevel::kLayered));
    cases.push_back(bsdf_case("coated blue milk glass from inside" + rough, material, SurfaceLevel::kLayered, true));
    material.thickness = 0.0f;
    cases.push_back(bsdf_case("coated thin blue glass" + rough, material, SurfaceLevel::kLayered));
  }
  scene::Material bumpy = white_material(0.3f);
  bumpy.clearcoat = 1.0f;
  bumpy.clearcoat_roughness = 0.3f;
  cases.push_back(bsdf_case("a coat with a normal of its own", bumpy, SurfaceLevel::kLayered));
  cases.back().bsdf.coat_normal = Vec3(0.2f, -0.1f, 0.9f).normalized();
  return cases;
}

/// Calls visit(scattering) with the case seen along `wo`; the normal is `normal`.
template <typename Visit>
void with_scattering(const BsdfCase& at, const Vec3& normal, const Vec3& wo, const Visit& visit) {
  switch (at.level) {
    case SurfaceLevel::kMatte:
      return visit(Scattering<SurfaceLevel::kMatte>(at.bsdf, normal, wo));
    case SurfaceLevel::kGlossy:
      return visit(Scattering<SurfaceLevel::kGlossy>(at.bsdf, normal, wo));
    case SurfaceLevel::kLayered:
      return visit(Scattering<SurfaceLevel::kLayered>(at.bsdf, normal, wo));
  }
}

/// Returns the direction at the angle `polar` from the z axis.
inline Vec3 direction(double polar, double azimuth) {
  return {static_cast<float>(std::sin(polar) * std::cos(azimuth)),
          static_cast<float>(std::sin(polar) * std::sin(azimuth)), static_cast<float>(std::cos(polar))};
}

}  // namespace cyclorama::render
