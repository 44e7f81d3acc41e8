// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/facings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::scene {

Facings facings_of(const Model& model) {
  constexpr std::size_t kMaxTriangles = 200'000;  // More triangles of one mesh would not change the result.
  Facings facings;
  std::array<Eigen::Vector3d, Facings::kSides> sides;
  for (int i = 0; i < Facings::kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / Facings::kSides;
    sides[static_cast<std::size_t>(i)] = {std::sin(angle), 0.0, std::cos(angle)};
  }
  for (const Instance& instance : model.instances) {
    const Mesh& mesh = model.meshes[static_cast<std::size_t>(instance.mesh)];
    const Eigen::Matrix3d linear = instance.T_model_mesh.linear();
    const std::size_t stride = mesh.triangles.size() / kMaxTriangles + 1;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
      const auto corner = [&](std::size_t k) {
        const auto& p = mesh.positions[mesh.triangles[i][k]];
        return Eigen::Vector3d(linear * Eigen::Vector3d(double{p[0]}, double{p[1]}, double{p[2]}));
      };
      const Eigen::Vector3d area = (corner(1) - corner(0)).cross(corner(2) - corner(0)) * static_cast<double>(stride);
      facings.both += area.cwiseAbs();
      facings.surplus += area;
      for (std::size_t side = 0; side < sides.size(); ++side) {
        facings.seen_from[side] += std::max(0.0, area.dot(sides[side]));
      }
    }
  }
  return facings;
}

}  // namespace cyclorama::scene
