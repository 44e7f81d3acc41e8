// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_material_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderfarm/scene/gltf_texture_use.h"

namespace cyclorama::scene {
namespace {

Result<Eigen::Vector3f> read_unit_colour(const GltfObject& from, const char* key) {
  TRY_ASSIGN(const auto colour, from.numbers<3>(key));
  if (!colour) return Eigen::Vector3f(Eigen::Vector3f::Ones());
  return Eigen::Vector3f(unit_colour({(*colour)[0], (*colour)[1], (*colour)[2], 1.0}).head<3>());
}

Status read_ior(const GltfObject& object, GltfNotes* notes, Material* ret_material) {
  TRY_ASSIGN(const std::optional<GltfObject> extension, object.extension("KHR_materials_ior"));
  if (!extension) return Done{};
  TRY_ASSIGN(const std::optional<double> ior, extension->number("ior"));
  if (!ior) return Done{};
  if (*ior < 1.0 && *ior != 0.0) notes->add("an index of refraction below 1 is taken as 1", extension->place());
  constexpr double kMaxValue = double{kMaxIor};
  ret_material->ior = *ior == 0.0 ? kMaxIor : static_cast<float>(std::clamp(*ior, 1.0, kMaxValue));
  return Done{};
}

Status read_specular(const GltfDocument& document, const GltfObject& object, GltfNotes* notes, Material* ret_material) {
  TRY_ASSIGN(const std::optional<GltfObject> extension, object.extension("KHR_materials_specular"));
  if (!extension) return Done{};
  TRY_ASSIGN(ret_material->specular, read_factor(*extension, "specularFactor", 1.0, 1.0, notes));
  TRY_ASSIGN(ret_material->specular_texture, read_texture_use(document, *extension, "specularTexture", notes));
  TRY_ASSIGN(const auto colour, extension->numbers<3>("specularColorFactor"));
  if (colour) {
    // Values above 1 are allowed: the product with the reflectance is clipped instead.
    constexpr double kBrightest = 1e6;
    for (int i = 0; i < 3; ++i) {
      const double value = (*colour)[static_cast<std::size_t>(i)];
      ret_material->specular_colour[i] = static_cast<float>(std::clamp(value, 0.0, kBrightest));
    }
  }
  TRY_ASSIGN(ret_material->specular_colour_texture,
             read_texture_use(document, *extension, "specularColorTexture", notes));
  return Done{};
}

Status read_clearcoat(const GltfDocument& document, const GltfObject& object, GltfNotes* notes,
                      Material* ret_material) {
  TRY_ASSIGN(const std::optional<GltfObject> extension, object.extension("KHR_materials_clearcoat"));
  if (!extension) return Done{};
  TRY_ASSIGN(ret_material->clearcoat, read_factor(*extension, "clearcoatFactor", 0.0, 1.0, notes));
  if (ret_material->clearcoat == 0.0f) return Done{};
  TRY_ASSIGN(ret_material->clearcoat_roughness, read_factor(*extension, "clearcoatRoughnessFactor", 0.0, 1.0, notes));
  TRY_ASSIGN(ret_material->clearcoat_texture, read_texture_use(document, *extension, "clearcoatTexture", notes));
  TRY_ASSIGN(ret_material->clearcoat_roughness_texture,
             read_texture_use(document, *extension, "clearcoatRoughnessTexture", notes));
  TRY_ASSIGN(ret_material->clearcoat_normal_texture,
             read_texture_use(document, *extension, "clearcoatNormalTexture", notes));
  TRY_ASSIGN(ret_material->clearcoat_normal_scale, read_normal_scale(*extension, "clearcoatNormalTexture"));
  return Done{};
}

Status read_transmission(const GltfDocument& document, const GltfObject& object, GltfNotes* notes,
                         Material* ret_material) {
  TRY_ASSIGN(const std::optional<GltfObject> extension, object.extension("KHR_materials_transmission"));
  if (!extension) return Done{};
  TRY_ASSIGN(ret_material->transmission, read_factor(*extension, "transmissionFactor", 0.0, 1.0, notes));
  if (ret_material->transmission == 0.0f) return Done{};
  TRY_ASSIGN(ret_material->transmission_texture, read_texture_use(document, *extension, "transmissionTexture", notes));
  return Done{};
}

Status read_volume(const GltfObject& object, GltfNotes* notes, Material* ret_material) {
  TRY_ASSIGN(const std::optional<GltfObject> extension, object.extension("KHR_materials_volume"));
  if (!extension) return Done{};
  constexpr double kMaxValue = double{std::numeric_limits<float>::max()};
  TRY_ASSIGN(ret_material->thickness, read_factor(*extension, "thicknessFactor", 0.0, kMaxValue, notes));
  TRY_ASSIGN(ret_material->attenuation_colour, read_unit_colour(*extension, "attenuationColor"));
  TRY_ASSIGN(const std::optional<double> distance, extension->number("attenuationDistance"));
  if (!distance) return Done{};
  if (!(*distance > 0.0)) notes->add("an attenuationDistance of 0 absorbs nothing", extension->place());
  ret_material->attenuation_distance = static_cast<float>(std::clamp(*distance, 0.0, kMaxValue));
  return Done{};
}

}  // namespace

Status read_material_layers(const GltfDocument& document, const GltfObject& object, GltfNotes* notes,
                            Material* ret_material) {
  TRY(read_ior(object, notes, ret_material));
  TRY(read_specular(document, object, notes, ret_material));
  TRY(read_clearcoat(document, object, notes, ret_material));
  TRY(read_transmission(document, object, notes, ret_material));
  return read_volume(object, notes, ret_material);
}

}  // namespace cyclorama::scene
