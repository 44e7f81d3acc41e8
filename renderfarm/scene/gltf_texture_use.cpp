// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_texture_use.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::scene {
namespace {

Status read_texture_transform(const GltfObject& texture_info, TextureUse* ret_use, std::uint64_t* ret_texcoord) {
  TRY_ASSIGN(const std::optional<GltfObject> extension, texture_info.extension("KHR_texture_transform"));
  if (!extension) return Done{};
  TRY_ASSIGN(const auto offset, extension->numbers<2>("offset"));
  TRY_ASSIGN(const auto scale, extension->numbers<2>("scale"));
  TRY_ASSIGN(const std::optional<double> rotation, extension->number("rotation"));
  TRY_ASSIGN(const std::optional<std::uint64_t> texcoord, extension->integer("texCoord"));
  const double c = std::cos(rotation.value_or(0.0));
  const double s = std::sin(rotation.value_or(0.0));
  const std::array<double, 2> by = scale.value_or(std::array{1.0, 1.0});
  const std::array<double, 2> move = offset.value_or(std::array{0.0, 0.0});
  // Rotates counter-clockwise on the screen, with v increasing downwards. Source: KHR_texture_transform and its test
  // model, whose marker shows the sign.
  Eigen::Matrix<double, 2, 3> transform;
  transform << c * by[0], s * by[1], move[0], -s * by[0], c * by[1], move[1];
  ret_use->transform = transform.cast<float>();
  *ret_texcoord = texcoord.value_or(*ret_texcoord);
  return Done{};
}

}  // namespace

Eigen::Vector4f unit_colour(const std::array<double, 4>& colour) {
  Eigen::Vector4f unit;
  for (int i = 0; i < 4; ++i) unit[i] = static_cast<float>(std::clamp(colour[static_cast<std::size_t>(i)], 0.0, 1.0));
  return unit;
}

Result<TextureUse> read_texture_use(const GltfDocument& document, const GltfObject& from, const char* key,
                                    GltfNotes* notes) {
  TextureUse use;
  TRY_ASSIGN(const std::optional<GltfObject> info, from.object(key));
  if (!info) return use;
  TRY_ASSIGN(const std::size_t texture, document.required_index(*info, "index", "textures"));
  TRY_ASSIGN(const std::optional<std::uint64_t> set, info->integer("texCoord"));
  std::uint64_t texcoord = set.value_or(0);
  TRY(read_texture_transform(*info, &use, &texcoord));
  if (!use.transform.allFinite()) return info->damaged("extensions", "the texture transform is too large");
  if (texcoord > 1) {
    notes->add("a texture uses a third set of texture coordinates: left out", info->place());
    return TextureUse{};
  }
  use.texture = static_cast<int>(texture);
  use.texcoord = static_cast<int>(texcoord);
  return use;
}

Result<float> read_factor(const GltfObject& from, const char* key, double fallback, double max, GltfNotes* notes) {
  TRY_ASSIGN(const std::optional<double> number, from.number(key));
  const double value = number.value_or(fallback);
  if (value < 0.0 || value > max) {
    notes->add(fmt::format("{} is outside [0, {}]: clipped", key, max), from.place());
  }
  return static_cast<float>(std::clamp(value, 0.0, max));
}

Result<float> read_normal_scale(const GltfObject& from, const char* key) {
  TRY_ASSIGN(const std::optional<GltfObject> info, from.object(key));
  if (!info) return 1.0f;
  TRY_ASSIGN(const std::optional<double> scale, info->number("scale"));
  return static_cast<float>(std::clamp(scale.value_or(1.0), -1e6, 1e6));
}

}  // namespace cyclorama::scene
