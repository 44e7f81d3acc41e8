// SPDX-License-Identifier: Apache-2.0
/// From a place on a surface to what it scatters and gives off: factors, textures, vertex colours.
#pragma once

#include "renderfarm/render/bsdf.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama {

/// What a point of a surface gives back and gives off.
struct Shading {
  Bsdf bsdf;
  Vec3 normal = Vec3::UnitY();
  Vec3 emission = Vec3::Zero();
};

template <SceneNeeds kNeeds>
Shading shading_at(const TriangleHit& hit, const SurfacePoint& point, const Vec3& wo, float cone_width) {
  const SurfaceMaterial& material = *hit.mesh->material;
  const Material& source = *material.source;
  const Footprint footprint{cone_width, point.facing.dot(wo)};
  const Eigen::Vector4f base = base_colour_at(hit, point.colour, kNeeds.textures, footprint);
  const Vec3 colour = base.head<3>().cwiseMax(0.0f);

  Shading shading;
  shading.normal = point.normal;
  shading.emission = source.emissive;
  if constexpr (kNeeds.normal_maps) shading.normal = mapped_normal(hit, point, footprint);
  if constexpr (kNeeds.textures) {
    if (material.emissive != nullptr) {
      const Vec2 uv = texcoord_at(hit, source.emissive_texture);
      const float lod = lod_of(hit, source.emissive_texture, *material.emissive, footprint);
      shading.emission = shading.emission.cwiseProduct(lookup(*material.emissive, uv, Coding::kSrgb, lod).head<3>());
    }
  }
  shading.bsdf = make_matte(colour);
  if constexpr (kNeeds.gloss) {
    if (material.glossy) {
      float metallic = source.metallic;
      float roughness = source.roughness;
      if constexpr (kNeeds.textures) {
        if (material.metallic_roughness != nullptr) {
          const Vec2 uv = texcoord_at(hit, source.metallic_roughness_texture);
          const float lod = lod_of(hit, source.metallic_roughness_texture, *material.metallic_roughness, footprint);
          const Eigen::Vector4f texel = lookup(*material.metallic_roughness, uv, Coding::kLinear, lod);
          roughness *= texel.y();
          metallic *= texel.z();
        }
      }
      shading.normal = reflecting_normal(shading.normal, point.facing, wo);
      shading.bsdf = make_glossy(colour, std::clamp(metallic, 0.0f, 1.0f), roughness);
    }
  }
  return shading;
}

}  // namespace cyclorama
