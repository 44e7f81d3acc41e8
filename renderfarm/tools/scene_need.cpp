// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/scene_need.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/text.h"
#include "renderfarm/render/bake.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/sky.h"

namespace cyclorama::tools {
namespace {

/// For each material, whether it is visible, and whether any of its meshes is partly transparent.
struct SeenMaterials {
  std::vector<bool> seen;
  std::vector<bool> blends;
};

SeenMaterials seen_materials(const scene::Model& model) {
  SeenMaterials found{std::vector<bool>(model.materials.size()), std::vector<bool>(model.materials.size())};
  const std::vector<int> uses = render::uses_of_meshes(model);
  const std::vector<bool> see_through = render::see_through_textures(model);
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    const scene::Mesh& mesh = model.meshes[i];
    if (uses[i] == 0 || mesh.triangles.empty()) continue;
    const auto material = static_cast<std::size_t>(mesh.material);
    found.seen[material] = true;
    if (render::blends(model.materials[material], mesh, see_through)) found.blends[material] = true;
  }
  return found;
}

/// Builds texts such as "2 materials: 'gold' (metal), 'tile'".
class MaterialList {
 public:
  void add(const scene::Material& material, const char* why = "") {
    constexpr int kNamed = 3;
    ++count_;
    if (count_ > kNamed + 1) return;
    if (count_ > 1) text_ += ", ";
    if (count_ > kNamed) {
      text_ += "...";
      return;
    }
    text_ += fmt::format("'{}'", printable(material.name));
    if (*why != '\0') text_ += fmt::format(" ({})", why);
  }
  [[nodiscard]] std::string text() const {
    if (count_ == 0) return "";
    return fmt::format("{} {}: {}", count_, count_ == 1 ? "material" : "materials", text_);
  }

 private:
  int count_ = 0;
  std::string text_;
};

const char* why_glossy(const scene::Material& material) {
  return material.metallic > 0.0f ? "metal" : "dielectric's gloss";
}

const char* why_layered(const scene::Material& material) {
  if (material.clearcoat > 0.0f && material.transmission > 0.0f) return "clear coat, transmission";
  return material.clearcoat > 0.0f ? "clear coat" : "transmission";
}

std::vector<NamedNeed> material_needs(const scene::Model& model) {
  const SeenMaterials found = seen_materials(model);
  std::set<int> textures;
  MaterialList textured, normal_mapped, glossy, layered, volumes, cut_outs, blended, emitters;
  for (std::size_t i = 0; i < model.materials.size(); ++i) {
    if (!found.seen[i]) continue;
    const scene::Material& material = model.materials[i];
    bool has_texture = false;
    for (scene::TextureUse scene::Material::*const at : scene::texture_places()) {
      if ((material.*at).texture < 0) continue;
      has_texture = true;
      textures.insert((material.*at).texture);
    }
    if (has_texture) textured.add(material);
    if (material.normal_texture.texture >= 0 || material.clearcoat_normal_texture.texture >= 0) {
      normal_mapped.add(material);
    }
    const render::SurfaceLevel level = render::surface_level_of(material, model.textures);
    if (level == render::SurfaceLevel::kGlossy) glossy.add(material, why_glossy(material));
    if (level == render::SurfaceLevel::kLayered) layered.add(material, why_layered(material));
    if (level == render::SurfaceLevel::kLayered && material.thickness > 0.0f && material.transmission > 0.0f) {
      volumes.add(material, material.attenuation_distance > 0.0f ? "absorbs" : "clear");
    }
    if (material.alpha_mode == scene::AlphaMode::kMask) cut_outs.add(material);
    if (found.blends[i]) blended.add(material);
    if (material.emissive.maxCoeff() > 0.0f) emitters.add(material);
  }
  const std::string texture_text = textures.empty() ? "" : fmt::format("{} in {}", textures.size(), textured.text());
  return {{"textures", texture_text},         {"normal maps", normal_mapped.text()},
          {"glossy surfaces", glossy.text()}, {"layered surfaces", layered.text()},
          {"volumes", volumes.text()},        {"alpha cut-outs", cut_outs.text()},
          {"alpha blending", blended.text()}, {"emitters", emitters.text()}};
}

std::string counted(std::ptrdiff_t count) { return count == 0 ? "" : fmt::format("{}", count); }

std::vector<NamedNeed> light_needs(const scene::Scene& scene) {
  const auto count = [&](const auto& is_such) {
    return counted(std::ranges::count_if(scene.model.lights, [&](const scene::Light& light) {
      return light.intensity.maxCoeff() > 0.0f && is_such(light);
    }));
  };
  const auto is_sun = [](const scene::Light& light) { return light.kind == scene::LightKind::kDirectional; };
  const auto has_area = [&](const scene::Light& light) {
    return !is_sun(light) && (scene::is_flat(light.kind) || light.radius_m > 0.0);
  };
  std::string environment;
  if (scene.environment != nullptr) {
    environment =
        fmt::format("a picture of {}x{}", scene.environment->pixels.width(), scene.environment->pixels.height());
  } else if (render::shines(scene.sky)) {
    environment = "a gradient";
  }
  return {{"lamps without size", count([&](const scene::Light& light) { return !is_sun(light) && !has_area(light); })},
          {"lamps with a size", count(has_area)},
          {"suns", count(is_sun)},
          {"environment", environment},
          {"ambient light", scene.ambient.isZero() ? "" : "everywhere"},
          {"eye lamp", scene.eye_lamp.isZero() ? "" : "at the eye"}};
}

std::string instancing(const scene::Model& model) {
  std::size_t meshes = 0;
  int times = 0;
  for (const int uses : render::uses_of_meshes(model)) {
    if (uses < 2) continue;
    ++meshes;
    times += uses;
  }
  return meshes == 0 ? "" : fmt::format("{} meshes stand {} times", meshes, times);
}

}  // namespace

std::vector<NamedNeed> named_needs(const scene::Scene& scene) {
  std::vector<NamedNeed> needs = material_needs(scene.model);
  for (NamedNeed& need : light_needs(scene)) needs.push_back(std::move(need));
  needs.push_back({"instancing", instancing(scene.model)});
  needs.push_back({"indirect light", scene.bounces == 0 ? "" : fmt::format("{} bounces", scene.bounces)});
  return needs;
}

}  // namespace cyclorama::tools
