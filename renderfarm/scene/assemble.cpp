// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/assemble.h"

#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace cyclorama {
namespace {

template <typename T>
void move_to_end(std::vector<T>* from, std::vector<T>* to) {
  to->insert(to->end(), std::make_move_iterator(from->begin()), std::make_move_iterator(from->end()));
}

Light placed(Light light, const Eigen::Affine3d& T_whole_file, double unit_m) {
  const double scale = std::cbrt(std::abs(T_whole_file.linear().determinant()));
  light.position = T_whole_file * light.position;
  light.direction = (T_whole_file.linear() * light.direction).normalized();
  if (light.kind == LightKind::kDirectional) return light;
  light.intensity *= static_cast<float>(unit_m * unit_m);
  light.radius_m *= scale;
  light.range_m *= scale;
  return light;
}

/// By vertex: does a triangle use it?
std::vector<bool> used_vertices(const Mesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = true;
  }
  return used;
}

}  // namespace

Eigen::Affine3d T_part_file(double unit_m, bool z_up) {
  Eigen::Affine3d T = Eigen::Affine3d::Identity();
  if (z_up) T.rotate(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  return Eigen::Scaling(unit_m) * T;
}

void add_part(Model part, double unit_m, const std::vector<Eigen::Affine3d>& T_whole_file, Model* whole) {
  const int first_texture = static_cast<int>(whole->textures.size());
  const int first_material = static_cast<int>(whole->materials.size());
  const int first_mesh = static_cast<int>(whole->meshes.size());
  for (Material& material : part.materials) {
    for (TextureUse* use : {&material.base_colour_texture, &material.metallic_roughness_texture,
                            &material.normal_texture, &material.emissive_texture}) {
      if (use->texture >= 0) use->texture += first_texture;
    }
  }
  for (Mesh& mesh : part.meshes) mesh.material += first_material;
  for (const Eigen::Affine3d& T : T_whole_file) {
    for (const Instance& instance : part.instances) {
      whole->instances.push_back({instance.mesh + first_mesh, T * instance.T_model_mesh});
    }
    for (const Light& light : part.lights) whole->lights.push_back(placed(light, T, unit_m));
  }
  move_to_end(&part.textures, &whole->textures);
  move_to_end(&part.materials, &whole->materials);
  move_to_end(&part.meshes, &whole->meshes);
  move_to_end(&part.notes, &whole->notes);
}

Eigen::AlignedBox3d bounds_of(const Model& model) {
  std::vector<std::vector<const Instance*>> instances_of(model.meshes.size());
  for (const Instance& instance : model.instances)
    instances_of[static_cast<std::size_t>(instance.mesh)].push_back(&instance);
  Eigen::AlignedBox3d bounds;
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    const Mesh& mesh = model.meshes[m];
    const std::vector<bool> used = used_vertices(mesh);
    for (const Instance* const instance : instances_of[m]) {
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (!used[i]) continue;
        const auto& p = mesh.positions[i];
        bounds.extend(instance->T_model_mesh *
                      (mesh.origin + Eigen::Vector3d(double{p[0]}, double{p[1]}, double{p[2]})));
      }
    }
  }
  return bounds;
}

}  // namespace cyclorama
