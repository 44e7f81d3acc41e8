// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/bake.h"

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

Eigen::Vector3d render_origin(const scene::Scene& scene) {
  if (scene.bounds.contains(scene.info.start_eye)) return scene.info.start_eye;
  const Eigen::Vector3d centre = scene.bounds.center();
  return !scene.bounds.isEmpty() && centre.allFinite() ? centre : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

std::vector<int> uses_of_meshes(const scene::Model& model) {
  std::vector<int> uses(model.meshes.size(), 0);
  for (const scene::Instance& instance : model.instances) ++uses[static_cast<std::size_t>(instance.mesh)];
  return uses;
}

void bake(scene::Mesh& mesh, const Eigen::Affine3d& T_scene_mesh, const Eigen::Vector3d& new_origin) {
  // A single transform for all vertices keeps equal corners equal, so that no cracks open.
  const Eigen::Matrix3d linear = T_scene_mesh.linear();
  const Eigen::Vector3d offset = T_scene_mesh * mesh.origin - new_origin;
  for (std::array<float, 3>& p : mesh.positions) {
    const Eigen::Vector3d moved = linear * Eigen::Vector3d(p[0], p[1], p[2]) + offset;
    p = {static_cast<float>(moved.x()), static_cast<float>(moved.y()), static_cast<float>(moved.z())};
  }
  mesh.origin = new_origin;
  if (linear.isIdentity(0.0)) return;
  const bool mirrored = linear.determinant() < 0.0;
  if (mirrored) {
    for (std::array<std::uint32_t, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
  }

  const Eigen::Matrix3f normal_matrix = normal_matrix_of(linear);
  for (std::array<float, 3>& n : mesh.normals) {
    const Vec3 turned = normalized_or(normal_matrix * to_vec3(n), to_vec3(n));
    n = {turned.x(), turned.y(), turned.z()};
  }
  const Eigen::Matrix3f turn = linear.cast<float>();
  for (std::array<float, 4>& t : mesh.tangents) {
    const Vec3 turned = normalized_or(turn * Vec3(t[0], t[1], t[2]), Vec3(t[0], t[1], t[2]));
    t = {turned.x(), turned.y(), turned.z(), mirrored ? -t[3] : t[3]};
  }
}

}  // namespace cyclorama::render
