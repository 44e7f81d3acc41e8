// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_specular_glossiness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderfarm/scene/gltf_texture_use.h"

namespace cyclorama::scene {
namespace {

constexpr float kDielectricSpecular = 0.04f;

float perceived_brightness(const Eigen::Vector3f& c) {
  return std::sqrt(0.299f * c.x() * c.x() + 0.587f * c.y() * c.y() + 0.114f * c.z() * c.z());
}

/// Solves for the metallic factor of a surface that reflects `diffuse` and `specular`: the root of the quadratic
/// equation that equates both models' energies. Source: Khronos' conversion sample for this extension (glTF repository,
/// extensions/Archived).
float solve_metallic(float diffuse, float specular, float one_minus_specular) {
  if (specular < kDielectricSpecular) return 0.0f;
  const float a = kDielectricSpecular;
  const float b = diffuse * one_minus_specular / (1.0f - a) + specular - 2.0f * a;
  const float c = a - specular;
  const float discriminant = std::max(b * b - 4.0f * a * c, 0.0f);
  return std::clamp((-b + std::sqrt(discriminant)) / (2.0f * a), 0.0f, 1.0f);
}

void convert_factors(const Eigen::Vector4f& diffuse, const Eigen::Vector3f& specular, Material* ret_material) {
  constexpr float kSmall = 1e-6f;
  const float one_minus_specular = 1.0f - specular.maxCoeff();
  const Eigen::Vector3f diffuse_rgb = diffuse.head<3>();
  const float metallic =
      solve_metallic(perceived_brightness(diffuse_rgb), perceived_brightness(specular), one_minus_specular);
  const Eigen::Vector3f from_diffuse =
      diffuse_rgb * (one_minus_specular / (1.0f - kDielectricSpecular) / std::max(1.0f - metallic, kSmall));
  const Eigen::Vector3f from_specular =
      (specular - Eigen::Vector3f::Constant(kDielectricSpecular * (1.0f - metallic))) / std::max(metallic, kSmall);
  const float share = metallic * metallic;
  const Eigen::Vector3f base = from_diffuse + share * (from_specular - from_diffuse);
  ret_material->metallic = metallic;
  ret_material->base_colour.head<3>() = base.cwiseMax(0.0f).cwiseMin(1.0f);
}

}  // namespace

Status read_specular_glossiness(const GltfDocument& document, const GltfObject& extension, GltfNotes* notes,
                                Material* ret_material) {
  TRY_ASSIGN(const auto diffuse, extension.numbers<4>("diffuseFactor"));
  TRY_ASSIGN(const auto specular, extension.numbers<3>("specularFactor"));
  TRY_ASSIGN(const std::optional<double> glossiness, extension.number("glossinessFactor"));
  const Eigen::Vector4f colour = unit_colour(diffuse.value_or(std::array{1.0, 1.0, 1.0, 1.0}));
  const std::array<double, 3> shine = specular.value_or(std::array{1.0, 1.0, 1.0});
  ret_material->base_colour = colour;
  ret_material->roughness = static_cast<float>(1.0 - std::clamp(glossiness.value_or(1.0), 0.0, 1.0));
  ret_material->metallic_roughness_texture = TextureUse{};
  TRY_ASSIGN(ret_material->base_colour_texture, read_texture_use(document, extension, "diffuseTexture", notes));
  if (ret_material->base_colour_texture.texture >= 0 || extension.has("specularGlossinessTexture")) {
    // If there are textures, the factors only multiply them and contain no information about metal.
    ret_material->metallic = 0.0f;
    constexpr float kMiddling = 0.5f;
    if (extension.has("specularGlossinessTexture"))
      ret_material->roughness = std::max(ret_material->roughness, kMiddling);
    notes->add("KHR_materials_pbrSpecularGlossiness is approximated: its specular texture is not used",
               extension.place());
  } else {
    convert_factors(colour, unit_colour({shine[0], shine[1], shine[2], 1.0}).head<3>(), ret_material);
  }
  return Done{};
}

}  // namespace cyclorama::scene
