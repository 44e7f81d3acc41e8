// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/mesh_repair.h"

#include <Eigen/Geometry>
#include <vector>

namespace cyclorama::scene {
namespace {

using Float3 = std::array<float, 3>;

Eigen::Vector3d vector_of(const Float3& p) { return Eigen::Vector3f(p[0], p[1], p[2]).cast<double>(); }

bool normalise(const Eigen::Vector3d& vector, Float3* ret_unit) {
  const double length = vector.stableNorm();
  if (!(length > 1e-30) || !std::isfinite(length)) return false;
  const Eigen::Vector3f unit = (vector / length).cast<float>();
  *ret_unit = {unit.x(), unit.y(), unit.z()};
  return true;
}

}  // namespace

void repair_normals(Mesh* mesh) {
  std::vector<bool> is_bad(mesh->normals.size(), false);
  bool any_bad = false;
  for (std::size_t i = 0; i < mesh->normals.size(); ++i) {
    if (normalise(vector_of(mesh->normals[i]), &mesh->normals[i])) continue;
    mesh->normals[i] = {0.0f, 0.0f, 0.0f};
    is_bad[i] = any_bad = true;
  }
  if (!any_bad) return;
  for (const auto& triangle : mesh->triangles) {
    if (!is_bad[triangle[0]] && !is_bad[triangle[1]] && !is_bad[triangle[2]]) continue;
    const Eigen::Vector3d a = vector_of(mesh->positions[triangle[0]]);
    const Eigen::Vector3d b = vector_of(mesh->positions[triangle[1]]);
    const Eigen::Vector3d c = vector_of(mesh->positions[triangle[2]]);
    Float3 unit{};
    if (!normalise((b - a).cross(c - a), &unit)) continue;
    for (const std::uint32_t corner : triangle) {
      if (!is_bad[corner]) continue;
      for (std::size_t k = 0; k < 3; ++k) mesh->normals[corner][k] += unit[k];
    }
  }
  for (std::size_t i = 0; i < mesh->normals.size(); ++i) {
    if (is_bad[i] && !normalise(vector_of(mesh->normals[i]), &mesh->normals[i])) mesh->normals[i] = {0.0f, 1.0f, 0.0f};
  }
}

}  // namespace cyclorama::scene
