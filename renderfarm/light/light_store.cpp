// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_store.h"

#include "renderfarm/light/mean_direction.h"

namespace cyclorama::light {

std::optional<Eigen::Vector3f> LightStore::in_grid(const SideLight& light, std::uint32_t grid,
                                                   const Eigen::Vector3f& weights) const {
  if (grid == TriangleGrid::kTraced) return std::nullopt;
  const int parts = TriangleGrid::parts(grid);
  const auto scale = static_cast<float>(parts);
  const float u = std::clamp(weights[1], 0.0f, 1.0f) * scale;
  const float v = std::clamp(weights[2], 0.0f, 1.0f) * scale;
  const int j = std::min(static_cast<int>(v), parts - 1);
  const int i = std::min(static_cast<int>(u), parts - 1 - j);
  const float part_u = std::min(u - static_cast<float>(i), 1.0f);
  const float part_v = std::min(v - static_cast<float>(j), 1.0f);
  const auto sample = [&](int column, int row) {
    return light
        .samples[TriangleGrid::offset(grid) + static_cast<std::uint32_t>(TriangleGrid::index(parts, column, row))];
  };
  // Each part is two triangles, except the last one of a row.
  if (part_u + part_v <= 1.0f || i + j == parts - 1) {
    const float rest = std::max(0.0f, 1.0f - part_u - part_v);
    return mixed<3>({sample(i, j), sample(i + 1, j), sample(i, j + 1)}, {rest, part_u, part_v});
  }
  return mixed<3>({sample(i + 1, j + 1), sample(i, j + 1), sample(i + 1, j)},
                  {part_u + part_v - 1.0f, 1.0f - part_u, 1.0f - part_v});
}

Eigen::Vector3f LightStore::direction_at(std::size_t placement, int side, std::uint32_t primitive,
                                         const std::array<std::uint32_t, 3>& vertices,
                                         const Eigen::Vector3f& weights) const {
  const SurfaceLight& surface = surfaces[placement];
  const SideLight& light = surface.sides[static_cast<std::size_t>(side)];
  if (light.directions.empty()) return Eigen::Vector3f::Zero();
  if (surface.base_per_triangle) return from_direction_code(light.directions[primitive]);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    sum += weights[static_cast<Eigen::Index>(i)] * from_direction_code(light.directions[vertices[i]]);
  }
  return sum;
}

std::size_t LightStore::sample_count() const {
  std::size_t count = 0;
  for (const SurfaceLight& surface : surfaces) {
    for (const SideLight& side : surface.sides) count += side.base.size() + side.samples.size();
  }
  return count;
}

std::size_t LightStore::bytes() const {
  std::size_t count = sample_count();
  for (const SurfaceLight& surface : surfaces) {
    for (const SideLight& side : surface.sides) count += side.grids.size() + side.directions.size();
  }
  return count * sizeof(std::uint32_t) + surfaces.size() * sizeof(SurfaceLight);
}

}  // namespace cyclorama::light
