// SPDX-License-Identifier: Apache-2.0
/// The material at one surface point: a Material with its textures applied. Reentrant.
#pragma once

#include <limits>

#include "renderfarm/render/surface_level.h"
#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::render {

/// Texture values at one point, decoded to linear; 1 where there is no texture. They multiply the material's factors.
struct SurfaceTexels {
  Vec3 base_colour = Vec3::Ones();  ///< Includes the vertex colour.
  float metallic = 1.0f;
  float roughness = 1.0f;
  float specular = 1.0f;
  Vec3 specular_colour = Vec3::Ones();
  float clearcoat = 1.0f;
  float clearcoat_roughness = 1.0f;
  float transmission = 1.0f;
};

/// Parameters of the reflection model. Colours are linear; colours and shares are in [0, 1]. The default has no gloss.
struct Bsdf {
  Vec3 base_colour = Vec3::Zero();
  float metallic = 0.0f;
  Vec3 f0 = Vec3::Zero();  ///< Reflectance of the dielectric at normal incidence.
  float f90 = 0.0f;        ///< Reflectance of the dielectric at grazing incidence.
  float alpha = 1.0f;      ///< GGX width: roughness squared.

  // Used only by SurfaceLevel::kLayered.
  float transmission = 0.0f;
  bool thin = true;       ///< Transmitted light keeps its direction.
  bool inside = false;    ///< The viewer is inside the body. Never set together with `thin`.
  float ior = 1.5f;       ///< Index of refraction of the body; at least 1.
  float specular = 1.0f;  ///< Scales the body's reflectance.
  float coat = 0.0f;      ///< Coated share of the surface.
  float coat_alpha = 0.0f;
  Vec3 coat_normal = Vec3::Zero();  ///< On the viewer's side; zero selects the surface's normal.
};

/// Minimum width of a lobe. Narrower lobes are mirrors, because neither float directions nor real lamps resolve them.
inline constexpr float kMinAlpha = 1e-3f;

[[nodiscard]] inline float alpha_of(float roughness) {
  const float r = roughness > 0.0f ? std::min(roughness, 1.0f) : 0.0f;
  return r * r < kMinAlpha ? 0.0f : r * r;
}

/// Returns a purely Lambertian surface.
[[nodiscard]] inline Bsdf make_matte(const Vec3& albedo) {
  Bsdf bsdf;
  bsdf.base_colour = albedo;
  return bsdf;
}

/// Sets the reflectance of a dielectric as glTF defines it. If `ior` is near 1, the reflectance vanishes at grazing
/// angles too, unlike Schlick's approximation.
inline void set_dielectric(float ior, float specular, const Vec3& specular_colour, Bsdf* bsdf) {
  const float root = (ior - 1.0f) / (ior + 1.0f);
  const float f0 = root * root;
  constexpr float kFullF0 = 0.02f;  // Reflectance of water, ior 1.33.
  bsdf->f0 = (f0 * specular_colour).cwiseMin(1.0f) * specular;
  bsdf->f90 = specular * std::min(1.0f, f0 / kFullF0);
  bsdf->ior = ior;
  bsdf->specular = specular;
}

/// Returns the material of glTF's metallic-roughness model without extensions.
[[nodiscard]] inline Bsdf make_glossy(const Vec3& base_colour, float metallic, float roughness) {
  Bsdf bsdf;
  bsdf.base_colour = base_colour;
  bsdf.metallic = std::clamp(metallic, 0.0f, 1.0f);
  bsdf.alpha = alpha_of(roughness);
  set_dielectric(1.5f, 1.0f, Vec3::Ones(), &bsdf);
  return bsdf;
}

/// Returns the material at a point. `inside` means that the ray hit the triangle's back, as given by its winding.
/// `level` is the kernel's; properties of higher levels are ignored.
[[nodiscard]] inline Bsdf make_bsdf(const scene::Material& material, const SurfaceTexels& texels, bool inside,
                                    SurfaceLevel level) {
  const auto unit = [](float value) { return std::clamp(value, 0.0f, 1.0f); };
  Bsdf bsdf;
  bsdf.base_colour = material.base_colour.head<3>().cwiseProduct(texels.base_colour).cwiseMax(0.0f).cwiseMin(1.0f);
  if (level == SurfaceLevel::kMatte) return bsdf;
  bsdf.metallic = unit(material.metallic * texels.metallic);
  bsdf.alpha = alpha_of(material.roughness * texels.roughness);
  set_dielectric(material.ior, unit(material.specular * texels.specular),
                 material.specular_colour.cwiseProduct(texels.specular_colour), &bsdf);
  if (level == SurfaceLevel::kGlossy) return bsdf;
  bsdf.transmission = unit(material.transmission * texels.transmission);
  bsdf.thin = !(material.thickness > 0.0f);
  bsdf.inside = inside && !bsdf.thin;
  bsdf.coat = unit(material.clearcoat * texels.clearcoat);
  bsdf.coat_alpha = alpha_of(material.clearcoat_roughness * texels.clearcoat_roughness);
  return bsdf;
}

/// Returns true if the material encloses a body, inside which transmitted rays continue.
[[nodiscard]] inline bool encloses_body(const scene::Material& material) {
  return material.transmission > 0.0f && material.thickness > 0.0f;
}

/// Returns the absorption per metre inside the body: exp(-absorption * metres) is transmitted. The result is finite,
/// and zero if nothing is absorbed.
[[nodiscard]] inline Vec3 absorption_of(const scene::Material& material) {
  const float distance = material.attenuation_distance;
  if (!encloses_body(material) || !(distance > 0.0f) || !std::isfinite(distance)) return Vec3::Zero();
  constexpr float kMaxAbsorption = 1e12f;
  Vec3 absorption;
  for (int i = 0; i < 3; ++i) {
    const float left = std::clamp(material.attenuation_colour[i], std::numeric_limits<float>::min(), 1.0f);
    absorption[i] = left < 1.0f ? std::min(-std::log(left) / distance, kMaxAbsorption) : 0.0f;
  }
  return absorption;
}

}  // namespace cyclorama::render
