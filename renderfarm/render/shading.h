// SPDX-License-Identifier: Apache-2.0
/// Material of a surface point from factors, textures and vertex colours.
#pragma once

#include "renderfarm/render/bsdf.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/render/surface_level.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {

/// Scattering and emission at a point of a surface.
struct Shading {
  Bsdf bsdf;
  Vec3 normal = Vec3::UnitY();
  Vec3 emission = Vec3::Zero();
  Vec3 absorption = Vec3::Zero();  ///< Per metre, in the medium behind the surface.
  /// BSDF sampling finds lights better than light sampling does, as for mirrors, clear glass and narrow highlights.
  bool sharp = false;
  /// Light from behind the normal contributes nothing.
  bool one_sided = true;
};

/// GGX width from which a lobe counts as wide: it blurs light so much that the directions of the light hardly matter.
inline constexpr float kWideAlpha = 0.5f;

/// Returns true if the material's wide lobes may read stored light. Paths are always traced at surfaces with coats or
/// glass.
[[nodiscard]] inline bool reads_stored_light(const SurfaceMaterial& material) {
  return material.level != SurfaceLevel::kLayered;
}

/// Looks up textures at one point.
class TexelReader {
 public:
  TexelReader(const TriangleHit& hit, const Footprint& footprint) : hit_(hit), footprint_(footprint) {}
  [[nodiscard]] Eigen::Vector4f at(const MipTexture* texture, const scene::TextureUse& use, Coding coding) const {
    if (texture == nullptr) return Eigen::Vector4f::Ones();
    return lookup(*texture, texcoord_at(hit_, use), coding, lod_of(hit_, use, *texture, footprint_));
  }

 private:
  const TriangleHit& hit_;
  const Footprint& footprint_;
};

/// Multiplies the base colour in `texels` by its texture, and sets the other values that kLevel needs from their
/// textures.
template <SurfaceLevel kLevel>
void read_texels(const SurfaceMaterial& material, const TexelReader& reader, SurfaceTexels* texels) {
  const scene::Material& source = *material.source;
  const Eigen::Vector4f base = reader.at(material.base_colour, source.base_colour_texture, Coding::kSrgb);
  texels->base_colour = texels->base_colour.cwiseProduct(base.head<3>());
  if constexpr (kLevel != SurfaceLevel::kMatte) {
    const Eigen::Vector4f rough =
        reader.at(material.metallic_roughness, source.metallic_roughness_texture, Coding::kLinear);
    texels->roughness = rough.y();
    texels->metallic = rough.z();
    texels->specular = reader.at(material.specular, source.specular_texture, Coding::kLinear).w();
    texels->specular_colour =
        reader.at(material.specular_colour, source.specular_colour_texture, Coding::kSrgb).head<3>();
  }
  if constexpr (kLevel == SurfaceLevel::kLayered) {
    texels->clearcoat = reader.at(material.clearcoat, source.clearcoat_texture, Coding::kLinear).x();
    texels->clearcoat_roughness =
        reader.at(material.clearcoat_roughness, source.clearcoat_roughness_texture, Coding::kLinear).y();
    texels->transmission = reader.at(material.transmission, source.transmission_texture, Coding::kLinear).x();
  }
}

template <SurfaceLevel kLevel>
Shading shading_at(const TriangleHit& hit, const SurfacePoint& point, const Vec3& wo, const Footprint& footprint) {
  /// GGX width below which highlights are `sharp`; light sampling finds the lights of wider ones just as well.
  constexpr float kSharpAlpha = 0.3f;
  const SurfaceMaterial& material = *hit.mesh->material;
  const scene::Material& source = *material.source;
  SurfaceTexels texels;
  texels.base_colour = point.colour;
  Shading shading;
  shading.normal = point.normal;
  shading.emission = source.emissive;
  if (source.unlit) {
    read_texels<SurfaceLevel::kMatte>(material, TexelReader(hit, footprint), &texels);
    shading.emission = make_bsdf(source, texels, false, SurfaceLevel::kMatte).base_colour;
    return shading;
  }
  const TexelReader reader(hit, footprint);
  read_texels<kLevel>(material, reader, &texels);
  const Eigen::Vector4f glow = reader.at(material.emissive, source.emissive_texture, Coding::kSrgb);
  shading.emission = shading.emission.cwiseProduct(glow.head<3>());
  shading.normal = mapped_normal(hit, point, footprint);
  if constexpr (kLevel == SurfaceLevel::kMatte) {
    shading.bsdf = make_bsdf(source, texels, false, SurfaceLevel::kMatte);
  } else {
    const bool matte = material.level == SurfaceLevel::kMatte;
    shading.bsdf = make_bsdf(source, texels, !point.front, matte ? SurfaceLevel::kMatte : kLevel);
    if (matte) return shading;
    shading.normal = reflecting_normal(shading.normal, point.facing, wo);
    shading.sharp = shading.bsdf.alpha < kSharpAlpha;
  }
  if constexpr (kLevel == SurfaceLevel::kLayered) {
    const bool layered = shading.bsdf.coat > 0.0f || shading.bsdf.transmission > 0.0f;
    shading.sharp |= layered;
    shading.one_sided = !(shading.bsdf.transmission > 0.0f && shading.bsdf.metallic < 1.0f);
    shading.absorption = material.absorption;
    // Without normal maps the coat has the surface's normal.
    const bool is_mapped = material.normal != nullptr || material.clearcoat_normal != nullptr;
    if (is_mapped && shading.bsdf.coat > 0.0f) shading.bsdf.coat_normal = coat_normal(hit, point, footprint);
  }
  return shading;
}

}  // namespace cyclorama::render
