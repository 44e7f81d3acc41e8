// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/assemble.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace cyclorama::scene {
namespace {

template <typename T>
void move_to_end(std::vector<T>* from, std::vector<T>* to) {
  to->insert(to->end(), std::make_move_iterator(from->begin()), std::make_move_iterator(from->end()));
}

double scale_of(const Eigen::Affine3d& T) { return std::cbrt(std::abs(T.linear().determinant())); }

Light placed(Light light, const Eigen::Affine3d& T_whole_file, double unit_m) {
  const double scale = scale_of(T_whole_file);
  light.position = T_whole_file * light.position;
  light.direction = (T_whole_file.linear() * light.direction).normalized();
  if (light.kind == LightKind::kDirectional) return light;
  // Radiance does not depend on the unit of length.
  if (!is_flat(light.kind)) light.intensity *= static_cast<float>(unit_m * unit_m);
  light.across = (T_whole_file.linear() * light.across).normalized();
  light.size_m *= scale;
  light.radius_m *= scale;
  light.range_m *= scale;
  return light;
}

Eigen::Vector3d corner_of(const Mesh& mesh, std::size_t index) {
  const auto& p = mesh.positions[index];
  return mesh.origin + Eigen::Vector3d(double{p[0]}, double{p[1]}, double{p[2]});
}

/// Returns, for each vertex, true if a triangle uses it.
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
    for (TextureUse Material::*const at : texture_places()) {
      if ((material.*at).texture >= 0) (material.*at).texture += first_texture;
    }
    // Placements of different scales share their materials; the scale of the first one is used.
    if (!T_whole_file.empty()) material.attenuation_distance *= static_cast<float>(scale_of(T_whole_file.front()));
  }
  for (Mesh& mesh : part.meshes) mesh.material += first_material;
  for (const SplatCloud& cloud : part.splats) {
    for (const Eigen::Affine3d& T : T_whole_file) {
      whole->splats.push_back(cloud);
      whole->splats.back().T_model_cloud = T * cloud.T_model_cloud;
    }
  }
  for (const Eigen::Affine3d& T : T_whole_file) {
    for (const Instance& instance : part.instances) {
      whole->instances.push_back({instance.mesh + first_mesh, T * instance.T_model_mesh});
    }
    for (const Light& light : part.lights) whole->lights.push_back(placed(light, T, unit_m));
    for (const Viewpoint& view : part.viewpoints) {
      whole->viewpoints.push_back({view.name, T * view.eye, (T.linear() * view.direction).normalized()});
    }
  }
  move_to_end(&part.textures, &whole->textures);
  move_to_end(&part.materials, &whole->materials);
  move_to_end(&part.meshes, &whole->meshes);
  move_to_end(&part.notes, &whole->notes);
  if (!part.credits.empty() && !whole->credits.empty()) whole->credits += "; ";
  whole->credits += part.credits;
}

void free_lamps(Model* model) {
  constexpr double kMaxGlobeM = 2.0;  // A larger emissive mesh counts as a glowing room.
  constexpr std::size_t kMaxCorners = 100'000;
  for (const Instance& instance : model->instances) {
    const Mesh& mesh = model->meshes[static_cast<std::size_t>(instance.mesh)];
    const Material& material = model->materials[static_cast<std::size_t>(mesh.material)];
    if (!(material.emissive.maxCoeff() > 0.0f) || mesh.positions.size() > kMaxCorners) continue;
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) box.extend(instance.T_model_mesh * corner_of(mesh, i));
    if (box.isEmpty() || box.sizes().maxCoeff() > kMaxGlobeM) continue;
    for (Light& light : model->lights) {
      const bool is_bulb = light.kind == LightKind::kPoint || light.kind == LightKind::kSpot;
      if (!is_bulb || !box.contains(light.position)) continue;
      double farthest = 0.0;
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        farthest = std::max(farthest, (instance.T_model_mesh * corner_of(mesh, i) - light.position).norm());
      }
      light.radius_m = std::max(light.radius_m, 1.01 * farthest);
    }
  }
}

Eigen::AlignedBox3d bounds_of(const Model& model) {
  std::vector<std::vector<const Instance*>> instances_of(model.meshes.size());
  for (const Instance& instance : model.instances)
    instances_of[static_cast<std::size_t>(instance.mesh)].push_back(&instance);
  Eigen::AlignedBox3d bounds;
  for (const SplatCloud& cloud : model.splats) bounds.extend(bounds_of(cloud));
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    const Mesh& mesh = model.meshes[m];
    const std::vector<bool> used = used_vertices(mesh);
    for (const Instance* const instance : instances_of[m]) {
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (!used[i]) continue;
        bounds.extend(instance->T_model_mesh * corner_of(mesh, i));
      }
    }
  }
  return bounds;
}

}  // namespace cyclorama::scene
