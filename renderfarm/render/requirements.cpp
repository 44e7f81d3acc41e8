// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/requirements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "renderfarm/render/lamps.h"
#include "renderfarm/render/sky.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama {

bool is_glossy(const Material& material) { return material.metallic > 0.0f || material.roughness < 1.0f; }

bool blends(const Model& model, const Material& material, const Mesh& mesh) {
  if (material.alpha_mode != AlphaMode::kBlend) return false;
  if (material.base_colour.w() < 1.0f) return true;
  const auto sees_through = [](const std::array<std::uint8_t, 4>& colour) { return colour[3] != 255; };
  if (std::any_of(mesh.colours.begin(), mesh.colours.end(), sees_through)) return true;
  const int texture = material.base_colour_texture.texture;
  return texture >= 0 && has_transparency(model.textures[static_cast<std::size_t>(texture)]);
}

SceneNeeds needs_of(const Scene& scene) {
  const Model& model = scene.model;
  SceneNeeds needs;
  std::vector<bool> used(model.meshes.size(), false);
  for (const Instance& instance : model.instances) used[static_cast<std::size_t>(instance.mesh)] = true;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Mesh& mesh = model.meshes[i];
    if (!used[i] || mesh.triangles.empty()) continue;
    const Material& material = model.materials[static_cast<std::size_t>(mesh.material)];
    needs.normal_maps |= material.normal_texture.texture >= 0;
    needs.textures |= needs.normal_maps || material.base_colour_texture.texture >= 0 ||
                      material.metallic_roughness_texture.texture >= 0 || material.emissive_texture.texture >= 0;
    needs.gloss |= is_glossy(material);
    needs.blending |= blends(model, material, mesh);
  }
  needs.lamps = !make_lamps(model.lights, Eigen::Vector3d::Zero()).empty();
  needs.sky = shines(scene.sky);
  return needs;
}

std::string describe(const SceneNeeds& needs) {
  std::vector<std::string> names;
  if (needs.textures) names.emplace_back("textures");
  if (needs.normal_maps) names.emplace_back("normal maps");
  if (needs.gloss) names.emplace_back("gloss");
  if (needs.blending) names.emplace_back("blending");
  if (needs.lamps) names.emplace_back("lamps");
  if (needs.sky) names.emplace_back("sky");
  return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace cyclorama
