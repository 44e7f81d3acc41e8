// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/requirements.h"

#include <algorithm>
#include <span>

#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {

namespace {

enum Channel : std::uint8_t { kRed, kGreen, kBlue, kAlpha };

/// A factor and the channel of a texture that multiplies it. Interpolation and mipmaps never leave the range of a
/// channel's texels, so the ends of that range bound the product.
class TexturedFactor {
 public:
  TexturedFactor(float factor, const scene::TextureUse& use, Channel channel,
                 const std::vector<scene::Texture>& textures)
      : factor_(factor), channel_(channel) {
    if (use.texture >= 0) texels_ = textures[static_cast<std::size_t>(use.texture)].pixels.data();
  }
  /// Returns true if the product is above 0 anywhere.
  [[nodiscard]] bool exceeds_0() const { return factor_ > 0.0f && (texels_.empty() || has_texel_other_than(0)); }
  /// Returns true if the product is below 1 anywhere.
  [[nodiscard]] bool falls_below_1() const { return factor_ < 1.0f || has_texel_other_than(255); }

 private:
  /// Returns true if any texel has another value than `code`. Stops at the first, which most textures have in their
  /// first row.
  [[nodiscard]] bool has_texel_other_than(std::uint8_t code) const {
    for (std::size_t i = channel_; i < texels_.size(); i += 4) {
      if (texels_[i] != code) return true;
    }
    return false;
  }

  float factor_;
  Channel channel_;
  std::span<const std::uint8_t> texels_;  ///< Empty if nothing multiplies the factor.
};

}  // namespace

SurfaceLevel surface_level_of(const scene::Material& material, const std::vector<scene::Texture>& textures) {
  if (material.unlit) return SurfaceLevel::kMatte;
  const auto textured = [&](float factor, const scene::TextureUse& use, Channel channel) {
    return TexturedFactor(factor, use, channel, textures);
  };
  const TexturedFactor metal = textured(material.metallic, material.metallic_roughness_texture, kBlue);
  const TexturedFactor roughness = textured(material.roughness, material.metallic_roughness_texture, kGreen);
  const TexturedFactor coat = textured(material.clearcoat, material.clearcoat_texture, kRed);
  const TexturedFactor transmission = textured(material.transmission, material.transmission_texture, kRed);
  const TexturedFactor specular = textured(material.specular, material.specular_texture, kAlpha);
  if (coat.exceeds_0() || (transmission.exceeds_0() && metal.falls_below_1())) return SurfaceLevel::kLayered;
  const scene::Material plain;
  const bool shines_specially = material.ior > plain.ior || material.specular_colour.maxCoeff() > 1.0f;
  const bool is_glossy = material.ior > 1.0f && (shines_specially || roughness.falls_below_1()) && specular.exceeds_0();
  return is_glossy || metal.exceeds_0() ? SurfaceLevel::kGlossy : SurfaceLevel::kMatte;
}

std::vector<bool> see_through_textures(const scene::Model& model) {
  std::vector<bool> used(model.textures.size(), false);
  for (const scene::Material& material : model.materials) {
    const int texture = material.base_colour_texture.texture;
    if (material.alpha_mode == scene::AlphaMode::kBlend && texture >= 0) used[static_cast<std::size_t>(texture)] = true;
  }
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = used[i] && has_transparency(model.textures[i]);
  return used;
}

bool blends(const scene::Material& material, const scene::Mesh& mesh, const std::vector<bool>& see_through) {
  if (material.alpha_mode != scene::AlphaMode::kBlend) return false;
  if (material.base_colour.w() < 1.0f) return true;
  const auto sees_through = [](const std::array<std::uint8_t, 4>& colour) { return colour[3] != 255; };
  if (std::any_of(mesh.colours.begin(), mesh.colours.end(), sees_through)) return true;
  const int texture = material.base_colour_texture.texture;
  return texture >= 0 && see_through[static_cast<std::size_t>(texture)];
}

SurfaceLevel highest_surface_level(const scene::Scene& scene) {
  const scene::Model& model = scene.model;
  SurfaceLevel highest = SurfaceLevel::kMatte;
  std::vector<bool> used(model.meshes.size(), false);
  for (const scene::Instance& instance : model.instances) used[static_cast<std::size_t>(instance.mesh)] = true;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const scene::Mesh& mesh = model.meshes[i];
    if (!used[i] || mesh.triangles.empty()) continue;
    const scene::Material& material = model.materials[static_cast<std::size_t>(mesh.material)];
    highest = std::max(highest, surface_level_of(material, model.textures));
  }
  return highest;
}

std::string_view describe(SurfaceLevel level) {
  switch (level) {
    case SurfaceLevel::kMatte:
      return "matte surfaces";
    case SurfaceLevel::kGlossy:
      return "glossy surfaces";
    case SurfaceLevel::kLayered:
      return "layered surfaces";
  }
  return "";
}

}  // namespace cyclorama::render
