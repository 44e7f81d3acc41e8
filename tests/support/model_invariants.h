// SPDX-License-Identifier: Apache-2.0
/// Checks the guarantees that model.h gives for every Model.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama {

template <typename Vectors>
bool all_finite(const Vectors& vectors) {
  for (const auto& vector : vectors) {
    for (const float value : vector) {
      if (!std::isfinite(value)) return false;
    }
  }
  return true;
}

/// Returns the first guarantee that `mesh` violates; an empty string if there is none.
inline std::string broken_promise(const scene::Mesh& mesh, const scene::Model& model) {
  const std::size_t n = mesh.positions.size();
  const auto fits = [&](const auto& vector) { return vector.empty() || vector.size() == n; };
  if (mesh.material < 0 || static_cast<std::size_t>(mesh.material) >= model.materials.size()) return "material index";
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= n) return "triangle index";
    }
  }
  if (!fits(mesh.normals) || !fits(mesh.texcoords[0]) || !fits(mesh.texcoords[1]) || !fits(mesh.tangents) ||
      !fits(mesh.colours)) {
    return "entries per vertex";
  }
  if (!mesh.origin.allFinite() || !all_finite(mesh.positions) || !all_finite(mesh.normals) ||
      !all_finite(mesh.texcoords[0]) || !all_finite(mesh.texcoords[1])) {
    return "finite numbers";
  }
  for (const auto& normal : mesh.normals) {
    if (!(std::abs(std::hypot(normal[0], normal[1], normal[2]) - 1.0f) < 1e-3f)) return "unit normals";
  }
  return "";
}

inline std::string broken_promise(const scene::Model& model) {
  if (model.materials.empty()) return "at least one material";
  const auto has_texture = [&](const scene::TextureUse& use) {
    return use.texture >= -1 && use.texture < static_cast<int>(model.textures.size());
  };
  for (const scene::Material& m : model.materials) {
    for (scene::TextureUse scene::Material::*const at : scene::texture_places()) {
      if (!has_texture(m.*at)) return "texture index";
    }
    const std::vector<std::array<float, 9>> factors = {{m.metallic, m.roughness, m.ior, m.specular, m.clearcoat,
                                                        m.clearcoat_roughness, m.transmission, m.thickness,
                                                        m.attenuation_distance}};
    if (!m.base_colour.allFinite() || !m.emissive.allFinite() || !m.specular_colour.allFinite() ||
        !m.attenuation_colour.allFinite() || !all_finite(factors)) {
      return "finite material";
    }
  }
  for (const scene::Mesh& mesh : model.meshes) {
    if (const std::string broken = broken_promise(mesh, model); !broken.empty()) return broken;
  }
  for (const scene::Instance& instance : model.instances) {
    if (instance.mesh < 0 || static_cast<std::size_t>(instance.mesh) >= model.meshes.size()) return "mesh index";
    if (!instance.T_model_mesh.matrix().allFinite()) return "finite transforms";
  }
  return "";
}

}  // namespace cyclorama
