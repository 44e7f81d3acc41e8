// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_material.h"

#include <string>
#include <utility>

#include "renderfarm/scene/gltf_material_layers.h"
#include "renderfarm/scene/gltf_specular_glossiness.h"
#include "renderfarm/scene/gltf_texture_use.h"

namespace cyclorama::scene {
namespace {

Status read_metallic_roughness(const GltfDocument& document, const GltfObject& object, GltfNotes* notes,
                               Material* ret_material) {
  TRY_ASSIGN(const std::optional<GltfObject> pbr, object.object("pbrMetallicRoughness"));
  if (!pbr) return Done{};
  TRY_ASSIGN(const auto base, pbr->numbers<4>("baseColorFactor"));
  if (base) ret_material->base_colour = unit_colour(*base);
  TRY_ASSIGN(ret_material->metallic, read_factor(*pbr, "metallicFactor", 1.0, 1.0, notes));
  TRY_ASSIGN(ret_material->roughness, read_factor(*pbr, "roughnessFactor", 1.0, 1.0, notes));
  TRY_ASSIGN(ret_material->base_colour_texture, read_texture_use(document, *pbr, "baseColorTexture", notes));
  TRY_ASSIGN(ret_material->metallic_roughness_texture,
             read_texture_use(document, *pbr, "metallicRoughnessTexture", notes));
  return Done{};
}

Status read_emission(const GltfDocument& document, const GltfObject& object, GltfNotes* notes, Material* ret_material) {
  TRY_ASSIGN(const auto factor, object.numbers<3>("emissiveFactor"));
  TRY_ASSIGN(ret_material->emissive_texture, read_texture_use(document, object, "emissiveTexture", notes));
  TRY_ASSIGN(const std::optional<GltfObject> extension, object.extension("KHR_materials_emissive_strength"));
  float strength = 1.0f;
  if (extension) {
    // Luminance of the sun's disc in nits; a larger value is a mistake and would overflow later.
    constexpr double kBrightest = 1e9;
    TRY_ASSIGN(strength, read_factor(*extension, "emissiveStrength", 1.0, kBrightest, notes));
  }
  if (factor) {
    const Eigen::Vector4f colour = unit_colour({(*factor)[0], (*factor)[1], (*factor)[2], 1.0});
    ret_material->emissive = colour.head<3>() * strength;
  }
  return Done{};
}

Status read_alpha(const GltfObject& object, GltfNotes* notes, Material* ret_material) {
  TRY_ASSIGN(const std::string mode, object.text_or("alphaMode", "OPAQUE"));
  if (mode == "MASK") {
    ret_material->alpha_mode = AlphaMode::kMask;
  } else if (mode == "BLEND") {
    ret_material->alpha_mode = AlphaMode::kBlend;
  } else if (mode != "OPAQUE") {
    notes->add("an unknown alphaMode is taken as OPAQUE", object.place());
  }
  TRY_ASSIGN(ret_material->alpha_cutoff, read_factor(object, "alphaCutoff", 0.5, 1e6, notes));
  TRY_ASSIGN(const std::optional<bool> double_sided, object.flag("doubleSided"));
  ret_material->double_sided = double_sided.value_or(false);
  return Done{};
}

Material plain_material() {
  Material material;
  // The specification's default is white metal. A file without materials is usually a scan, and stone is not metal.
  material.metallic = 0.0f;
  return material;
}

/// Returns the parts of a material that an unlit surface shows: base colour and alpha.
Material unlit_material(Material full) {
  Material material = plain_material();
  material.unlit = true;
  material.name = std::move(full.name);
  material.base_colour = full.base_colour;
  material.base_colour_texture = full.base_colour_texture;
  material.alpha_mode = full.alpha_mode;
  material.alpha_cutoff = full.alpha_cutoff;
  material.double_sided = full.double_sided;
  return material;
}

}  // namespace

Result<Material> read_gltf_material(const GltfDocument& document, const GltfObject& object, GltfNotes* notes) {
  Material material;
  material.name = object.name();
  TRY(read_metallic_roughness(document, object, notes, &material));
  TRY_ASSIGN(const std::optional<GltfObject> glossiness, object.extension("KHR_materials_pbrSpecularGlossiness"));
  if (glossiness) TRY(read_specular_glossiness(document, *glossiness, notes, &material));
  TRY_ASSIGN(material.normal_texture, read_texture_use(document, object, "normalTexture", notes));
  TRY_ASSIGN(material.normal_scale, read_normal_scale(object, "normalTexture"));
  TRY(read_emission(document, object, notes, &material));
  TRY(read_alpha(object, notes, &material));
  TRY(read_material_layers(document, object, notes, &material));
  TRY_ASSIGN(const std::optional<GltfObject> unlit, object.extension("KHR_materials_unlit"));
  if (unlit) return unlit_material(std::move(material));
  if (object.has("occlusionTexture")) {
    notes->add("occlusion textures are not used: the light is traced instead", object.place());
  }
  return material;
}

Result<int> GltfMaterials::load(std::optional<std::size_t> index, const std::array<bool, 2>& has_texcoords,
                                std::string_view place) {
  const auto key = std::make_tuple(index, has_texcoords[0], has_texcoords[1]);
  const auto known = loaded_.find(key);
  if (known != loaded_.end()) return known->second;
  TRY_ASSIGN(const int loaded, load_new(index, has_texcoords, place));
  loaded_.emplace(key, loaded);
  return loaded;
}

Result<int> GltfMaterials::load_new(std::optional<std::size_t> index, const std::array<bool, 2>& has_texcoords,
                                    std::string_view place) {
  Material material = plain_material();
  if (index) {
    TRY_ASSIGN(const GltfObject object, document_->item("materials", *index));
    TRY_ASSIGN(material, read_gltf_material(*document_, object, &context_->notes));
  }
  for (TextureUse Material::*const at : texture_places()) {
    TextureUse& use = material.*at;
    if (use.texture < 0) continue;
    if (!has_texcoords[static_cast<std::size_t>(use.texcoord)]) {
      context_->notes.add("a texture has no texture coordinates: left out", place);
      use = TextureUse{};
      continue;
    }
    TRY_ASSIGN(use.texture, textures_.load(static_cast<std::size_t>(use.texture)));
    if (use.texture < 0) use = TextureUse{};
  }
  TRY(context_->budget.take(place, 1, sizeof material));
  model_->materials.push_back(std::move(material));
  return static_cast<int>(model_->materials.size()) - 1;
}

}  // namespace cyclorama::scene
